// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

// The Python module, one file a subject. What Python sees of it is in gatefly/_gatefly.pyi.
namespace gatefly::python {

namespace py = pybind11;

void bind_picture(py::module_& m);
void bind_detector(py::module_& m);
void bind_pose(py::module_& m);
void bind_messages(py::module_& m);
void bind_race(py::module_& m);  ///< race.cpp, or race_without_simulator.cpp.
void bind_replay(py::module_& m);

/// Ctrl-C, and whatever else Python wants to do in between; for who has let go of the interpreter.
/// @throws py::error_already_set KeyboardInterrupt.
inline void check_signals() {
  const py::gil_scoped_acquire python;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace gatefly::python
