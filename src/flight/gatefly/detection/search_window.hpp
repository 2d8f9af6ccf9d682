// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gatefly {

/// The part of a picture where a gate can be, and how it can look there. [ours]
struct SearchWindow {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;  ///< [px]
  // Known of its look; by default it may be any:
  double least_side = 0.0, most_side = 1e6;    ///< Length of its upright sides [px].
  double least_width = 0.0, most_width = 1e3;  ///< Its level sides, as a part of the upright ones.
  double least_roll = -1e3, most_roll = 1e3;   ///< Turned clockwise [rad].
  /// It is searched for one gate, of which all of that is known: fewer places are looked at closely.
  bool for_one = false;
};

}  // namespace gatefly
