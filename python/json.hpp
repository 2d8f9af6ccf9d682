// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <pybind11/pybind11.h>

namespace gatefly::python {

/// As Python's json.loads() would have it.
[[nodiscard]] pybind11::object python_of(const nlohmann::json& json);
[[nodiscard]] pybind11::object python_of(const nlohmann::ordered_json& json);

}  // namespace gatefly::python
