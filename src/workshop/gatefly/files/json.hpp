// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

namespace gatefly::files {

/// `value` for a JSON file; null for NaN and infinity, which have no place there.
[[nodiscard]] inline nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

/// A value as an error message shows it: about 60 bytes of it on one line, of a list 200.
[[nodiscard]] std::string shown(const nlohmann::json& value);
[[nodiscard]] std::string shown(const nlohmann::ordered_json& value);

/// As a file or a program gets it, with a line break at its end. What is no UTF-8 is replaced: names
/// of files may be anything.
[[nodiscard]] std::string json_text(const nlohmann::json& value);
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& value);

}  // namespace gatefly::files
