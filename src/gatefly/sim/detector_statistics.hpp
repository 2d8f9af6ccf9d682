// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace gatefly::sim {

/// How often a detector finds a whole gate that is nearer than `below`.
struct HitRate {
  double below = 0.0;  ///< From the camera to the gate's centre [m].
  double rate = 0.0;
};

/// What a detector does, in numbers: all that ideal vision knows about it.
struct DetectorStatistics {
  /// By distance, ascending; beyond the last one nothing is found.
  std::vector<HitRate> hits;
  double corner_sigma_px = 0.0;  ///< Each coordinate of each corner.
  double outlier_rate = 0.0;     ///< Of a corner: a normal error is joined by a big one ...
  double outlier_low_px = 0.0, outlier_high_px = 0.0;  ///< ... of this length.
  double false_alarms = 0.0;                           ///< Per picture: quads that are no gate.
  double lower_corners_rate = 0.0;                     ///< Of gates cut off above, within reach.
  double lower_corners_sigma_px = 0.0;  ///< Each coordinate of its two lower corners.
  double bars_rate = 0.0;               ///< Of pairs of side bars, within reach.
  double bars_sigma_px = 0.0;           ///< Of the middle of a bar, across.
};

/// @throws std::invalid_argument for another name than "ours" and "paper".
[[nodiscard]] DetectorStatistics statistics_of(const std::string& detector);

}  // namespace gatefly::sim
