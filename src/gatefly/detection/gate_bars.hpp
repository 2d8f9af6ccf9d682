// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/sensing/color_range.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

struct GateBarsParams {
  double min_height = 0.35;  ///< Coloured part of a column, smoothed. [ours; Li18 code: 0.28]
  double min_ratio = 0.5;    ///< Lower peak / higher peak. [Li18 flight code]
  int smoothing_px = 8;      ///< Box filter over the columns. [Li18 flight code]
  double min_gap_px = 40.0;  ///< Between the bars; a 1 m gate at 1.8 m spans 90 px. [ours]
};

/// The two side bars of a gate that no longer fits into the picture.
struct GateBars {
  Eigen::Vector2d left_px, right_px;  ///< Centre of the coloured pixels of each bar.
};

/// Finds the side bars as the two peaks of the column histogram. Li18 §3.1, last paragraph.
///
/// Differs: every second row is counted instead of random hits. A tilted camera draws upright bars
/// slanted, all towards the image of straight down: columns are counted along those lines. A bar answers
/// with the *centre* of its pixels, u and v (docs/paper/deviations.md#eq-10).
/// @param nadir_px  image of straight down, outside the picture; nullopt for a level camera.
/// @return nullopt when there are not two peaks that are high and alike enough.
[[nodiscard]] std::optional<GateBars> detect_bars(const Image& image, const ColorRange& color,
                                                  const GateBarsParams& params,
                                                  const std::optional<Eigen::Vector2d>& nadir_px = std::nullopt);

}  // namespace gatefly
