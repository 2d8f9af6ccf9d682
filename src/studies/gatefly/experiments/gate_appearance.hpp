// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "gatefly/experiments/twin_pictures.hpp"

namespace gatefly::experiments {

/// Looks of a gate and its picture: what detectors live on, in numbers.
struct GateAppearance {
  double side_px = 0.0;
  double aspect = 0.0;     ///< Width / height.
  double bar_share = 0.0;  ///< Bar's width / side: of its colour's excess, at half its height.
  double cb_step = 0.0, cr_step = 0.0;  ///< Bar minus what is beside it, median along all sides.
  double uneven = 0.0;        ///< Standard deviation of Cr - Cb along a side, mean of the sides.
  double worst_side = 0.0;    ///< Least part of a side that has the gate's colour.
  double luma_edge_px = 0.0;  ///< Width of the picture's strong edges in Y, and in Cr.
  double chroma_edge_px = 0.0;
  double edges = 0.0;        ///< Part of the picture's pixels on a luma edge.
  double cr_minus_cb = 0.0;  ///< On the bar.
};

[[nodiscard]] GateAppearance appearance_of(const TwinPicture& picture);

/// Its numbers with their names, in order.
struct Feature {
  const char *key, *name;
  double GateAppearance::*value;
};
[[nodiscard]] std::span<const Feature> features();

}  // namespace gatefly::experiments
