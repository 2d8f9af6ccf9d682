// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/snake_gate.hpp"

namespace gatefly {

/// A gate whose upper bar is above the picture: two side bars standing on a lower one.
struct OpenGate {
  Eigen::Vector2d bottom_left_px, bottom_right_px;  ///< Outer lower corners, sub-pixel.
  double color_fitness = 0.0;                       ///< Over the three bars in view.
};

/// Finds a gate that is cut off above: from 3 m on a camera that looks down loses the upper bar. Ours.
///
/// The same snakes as detect_gates: up a bar to the upper border, down to its foot, along the lower bar,
/// up the other one. Each of the three bars is checked, and the inside is empty.
/// @return the fittest; nullopt when there is none, or when the gate is not cut by the upper border.
[[nodiscard]] std::optional<OpenGate> detect_open_gate(const Image& image, const ColorRange& color,
                                                       const SnakeGateParams& params, Rng& rng);

}  // namespace gatefly
