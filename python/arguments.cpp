// SPDX-License-Identifier: Apache-2.0
#include "arguments.hpp"

#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "gatefly/files/text.hpp"

namespace gatefly::python {
namespace {

namespace py = pybind11;

std::string type_of(py::handle value) {
  return py::str(py::type::handle_of(value).attr("__name__"));
}

bool is_path(py::handle value) {
  return py::isinstance<py::str>(value) || py::hasattr(value, "__fspath__");
}

/// A value as TOML writes it.
std::string toml_of(py::handle value, const std::string& key) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::int_>(value)) return py::str(value);
  if (py::isinstance<py::float_>(value)) {
    if (!std::isfinite(value.cast<double>()))
      throw std::runtime_error(key + ": " + std::string(py::str(value)) + ", must be finite");
    return py::repr(py::float_(value.cast<double>()));
  }
  if (is_path(value)) return nlohmann::json(path_of(value, "a setting")).dump();
  if (py::hasattr(value, "tolist"))  // numpy's numbers and arrays
    return toml_of(value.attr("tolist")(), key);
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    std::string list;
    for (const py::handle each : value) list += (list.empty() ? "" : ", ") + toml_of(each, key);
    return "[" + list + "]";
  }
  throw py::type_error(key + ": a setting is a number, a bool, a str or a list of them, not " +
                       type_of(value));
}

std::vector<std::string> configs_of(const py::object& config) {
  if (config.is_none()) return {};
  if (is_path(config)) return {path_of(config, "config")};
  if (!py::isinstance<py::list>(config) && !py::isinstance<py::tuple>(config))
    throw py::type_error("config is a file, a name in configs/ or a list of them, not " +
                         type_of(config));
  std::vector<std::string> configs;
  for (const py::handle each : config) configs.push_back(path_of(each, "config"));
  return configs;
}

std::vector<std::string> settings_of(const py::object& settings) {
  std::vector<std::string> result;
  if (settings.is_none()) return result;
  if (py::isinstance<py::dict>(settings)) {
    for (const auto& [name, value] : settings.cast<py::dict>()) {
      if (!py::isinstance<py::str>(name))
        throw py::type_error("settings: a key is a str such as 'control.speed_mps', not " +
                             type_of(name));
      const std::string key = py::str(name);
      result.push_back(key + "=" + toml_of(value, key));
    }
    return result;
  }
  if (py::isinstance<py::list>(settings) || py::isinstance<py::tuple>(settings)) {
    for (const py::handle each : settings) {
      if (!py::isinstance<py::str>(each))
        throw py::type_error("settings: each is a str 'section.key=value', not " + type_of(each));
      result.push_back(py::str(each));
    }
    return result;
  }
  throw py::type_error("settings is a dict {'section.key': value}, not " + type_of(settings));
}

}  // namespace

std::string path_of(py::handle value, const char* what) {
  if (!is_path(value))
    throw py::type_error(std::string{what} + " is a str or a path, not " + type_of(value));
  const auto text = py::reinterpret_steal<py::object>(PyOS_FSPath(value.ptr()));
  if (!text) throw py::error_already_set();
  if (!py::isinstance<py::str>(text))
    throw py::type_error(std::string{what} + " is a str or a path, not " + type_of(text));
  return py::str(text);
}

tasks::ConfigArguments config_arguments(const py::object& config, const py::object& settings) {
  return {.configs = configs_of(config), .settings = settings_of(settings)};
}

void warn(const std::vector<std::string>& notes) {
  for (const std::string& note : notes)
    if (PyErr_WarnEx(PyExc_UserWarning, note.c_str(), 1) != 0) throw py::error_already_set();
}

}  // namespace gatefly::python
