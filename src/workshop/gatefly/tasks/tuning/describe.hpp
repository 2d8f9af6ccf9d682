// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

namespace gatefly::tuning {

/// A colour as somebody says it: "orange", "dark blue", "#ff6600", "255, 102, 0", "1, 0.4, 0";
/// sRGB, each 0..1.
///
/// Only the hue counts for ColorModel::described(), so "dark" and "light" change nothing.
/// @throws std::invalid_argument for no colour, and for one without a hue: white, grey, black.
[[nodiscard]] std::array<double, 3> described_color(const std::string& text);

}  // namespace gatefly::tuning
