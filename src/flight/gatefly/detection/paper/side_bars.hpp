// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/geometry/rng.hpp"
#include "gatefly/sensing/color_range.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// The histogram that finds the side bars of a gate too near to be whole. [Li18 flight code,
/// basement, March 2018]
struct SideBarsParams {
  ColorRange color{
      .y_min = 20, .y_max = 228, .u_min = 66, .u_max = 194, .v_min = 132, .v_max = 230};
  int samples = 10'000;  ///< Random pixels; the histogram counts those that hit.
  int smoothing = 8;     ///< Columns that are averaged: i-4 .. i+3.
  /// Mean of the two peaks / what a column coloured from top to bottom would have. [9 hits of 31.7]
  double min_height = 0.284;
  double min_ratio = 0.5;  ///< Lower peak / higher peak.
};

/// Coloured pixels by column; its two highest peaks are the gate's side bars. Li18 §3.1, last
/// paragraph.
///
/// Differs: a bar's point is on the row where its hits are on average (the paper: the row of the
/// optical axis), docs/paper/deviations.md#paper-mode.
/// @param rng  source of the samples. Allocates nothing; pictures wider than 4096 px have no bars.
[[nodiscard]] std::optional<GateBars> side_bars_by_histogram(const Image& image,
                                                             const SideBarsParams& params,
                                                             Rng& rng);

}  // namespace gatefly
