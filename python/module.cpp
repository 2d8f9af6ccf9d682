// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <stdexcept>

#include "gatefly/files/text.hpp"

#include "bindings.hpp"

namespace {

namespace py = pybind11;

constexpr const char* kAboutError =
    "What was given cannot be used: a file, key or value. One line, the same that the program "
    "says.";

py::handle error_type;

/// Translates the libraries' exceptions about input; Python's own pass unchanged.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const std::runtime_error& error) {
    PyErr_SetString(error_type.ptr(), gatefly::files::reason_of(error).c_str());
  } catch (const std::invalid_argument& error) {
    PyErr_SetString(error_type.ptr(), gatefly::files::reason_of(error).c_str());
  }
}

}  // namespace

PYBIND11_MODULE(_gatefly, m) {
  using namespace gatefly::python;
  m.doc() = "The compiled part of gatefly: import gatefly instead.";
  m.attr("__version__") = GATEFLY_VERSION;
  error_type = PyErr_NewExceptionWithDoc("gatefly.Error", kAboutError, PyExc_ValueError, nullptr);
  m.attr("Error") = error_type;
  py::register_exception_translator(translate);

  bind_picture(m);
  bind_detector(m);
  bind_pose(m);
  bind_messages(m);
  bind_race(m);
  bind_replay(m);
}
