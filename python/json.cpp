// SPDX-License-Identifier: Apache-2.0
#include "json.hpp"

#include <cstdint>
#include <string>

namespace gatefly::python {
namespace {

namespace py = pybind11;

template <class Json>
py::object converted(const Json& json) {
  if (json.is_boolean()) return py::bool_(json.template get<bool>());
  if (json.is_number_unsigned()) return py::int_(json.template get<std::uint64_t>());
  if (json.is_number_integer()) return py::int_(json.template get<std::int64_t>());
  if (json.is_number()) return py::float_(json.template get<double>());
  if (json.is_string()) return py::str(json.template get<std::string>());
  if (json.is_array()) {
    py::list list;
    for (const auto& each : json) list.append(converted(each));
    return list;
  }
  if (json.is_object()) {
    py::dict dict;
    for (const auto& [key, value] : json.items()) dict[py::str(key)] = converted(value);
    return dict;
  }
  return py::none();
}

}  // namespace

py::object python_of(const nlohmann::json& json) { return converted(json); }
py::object python_of(const nlohmann::ordered_json& json) { return converted(json); }

}  // namespace gatefly::python
