// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/race/pilot_config.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::simulated_race {

/// The truth of what the filter estimates, less what the pilot was told. Names and signs are
/// those of eskf::Findings.
struct TruthOfFindings {
  double tilt = 0.0, pan = 0.0, roll = 0.0;  ///< Mount: down, to the right, clockwise [rad].
  /// An image centre elsewhere than told looks like that much more tilt and pan near the middle of
  /// the picture; a filter that knows no centre finds the sum [rad].
  double center_as_tilt = 0.0, center_as_pan = 0.0;
  /// Pictures are that much older than told when they arrive, jitter aside [s].
  double latency = 0.0;
  double latency_jitter = 0.0;  ///< Mean of the jitter, which only delays [s].
  double focal = 0.0;           ///< Relative, in the picture's middle.
  double start_heading = 0.0;   ///< Clockwise on the pad [rad].
  /// Specific thrust at the rotor speed that hovers by the pilot's parameters / g, without battery
  /// and floor: 1 when all is as told.
  double hover_thrust = 1.0;
  int moved_gate = 0;  ///< By [faults], from 1; drawn where it asked for that. 0: none.
};

/// @param truth  drawn for a seed. @param told  the pilot of the same race.
[[nodiscard]] TruthOfFindings truth_of_findings(const world::SimConfig& truth,
                                                const PilotConfig& told);

}  // namespace gatefly::simulated_race
