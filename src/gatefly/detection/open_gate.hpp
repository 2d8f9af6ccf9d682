// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"
#include "gatefly/geometry/rng.hpp"
#include "gatefly/sensing/color_range.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

struct OpenGateParams {
  int max_samples = 2'000;                              ///< Random pixels per saturation level. [ours]
  std::array<int, 5> chroma_levels{52, 38, 27, 18, 0};  ///< Least saturation, tried in turn. [ours]
  double sure_fitness = 0.85;                           ///< Colour fitness at which the search ends. [ours]
  double min_width_px = 40.0;                           ///< Of the lower bar: a 1 m gate at 4 m. [ours]
  double max_inside = 0.25;                             ///< Coloured part of the central box. [Li18 flight code]
  double bar_ratio = 0.05;                              ///< Bar width / outer side of the gate.
};

/// A gate whose upper bar is above the picture: two side bars standing on a lower one.
struct OpenGate {
  Eigen::Vector2d bottom_left_px, bottom_right_px;  ///< Outer lower corners, sub-pixel.
  double fitness = 0.0;                            ///< Over the three bars in view.
};

/// Finds a gate that is cut off above: from 3 m on a camera that looks down loses the upper bar. Ours.
///
/// Li18's snakes (Algorithm 2): up a bar to the upper border, down to its foot, along the lower bar,
/// up the other one. Each of the three bars is checked, and the inside is empty.
/// @return the fittest; nullopt when there is none, or when the gate is not cut by the upper border.
[[nodiscard]] std::optional<OpenGate> detect_open_gate(const Image& image, const ColorRange& color,
                                                       const OpenGateParams& params, Rng& rng);

}  // namespace gatefly
