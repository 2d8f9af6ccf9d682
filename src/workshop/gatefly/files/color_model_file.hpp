// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "gatefly/detection/color_model.hpp"

namespace gatefly::files {

/// A colour model as TOML: version = 1, about = "what it was fitted to", absolute = [...], relative
/// = [...].
///
/// Each table is 16 texts, one for every luma bin, of 1024 letters, one for every chroma bin (row
/// u, column v). A letter A-Z, a-z, 0-9, +, / is a step of 1/8 nat: A is -4, g is 0, / is 3.875.
/// What lies between is rounded.
[[nodiscard]] std::string color_model_text(const ColorModel& model, const std::string& about);

/// Reads what color_model_text() wrote. @throws std::runtime_error one line: file, key, what is
/// wrong, what is allowed.
[[nodiscard]] ColorModel read_color_model(const std::filesystem::path& path);

}  // namespace gatefly::files
