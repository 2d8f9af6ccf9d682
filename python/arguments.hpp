// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "gatefly/tasks/arguments.hpp"

namespace gatefly::python {

/// A str or os.PathLike. @throws TypeError naming `what`.
[[nodiscard]] std::string path_of(pybind11::handle value, const char* what);

/// Arguments as Python has them.
/// @param config    None, a file or name, or several of them.
/// @param settings  None, {"section.key": value}, or ["section.key=value"].
[[nodiscard]] tasks::ConfigArguments config_arguments(const pybind11::object& config,
                                                      const pybind11::object& settings);

/// Raises a UserWarning for each of a configuration's warnings.
void warn(const std::vector<std::string>& notes);

}  // namespace gatefly::python
