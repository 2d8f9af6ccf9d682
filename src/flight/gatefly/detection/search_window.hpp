// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gatefly {

/// The part of a picture where a gate can be, and how it can look there. [ours]
struct SearchWindow {
  double left, top, right, bottom;  ///< [px]
  double least_side, most_side;     ///< Of its upright sides [px].
  // What is known of its look, else any:
  double least_width = 0.0, most_width = 1e3;  ///< Of its level sides, by its upright ones.
  double least_roll = -1e3, most_roll = 1e3;   ///< Clockwise [rad].
  /// For one gate, of which something is known: fewer places and frames are looked at closely.
  bool for_one = false;
};

}  // namespace gatefly
