// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sensing/imu.hpp"

namespace gatefly::experiments {

/// One IMU sample of a flight whose attitude is known.
struct Moment {
  Imu imu;
  double dt = 0.0;  ///< Since the sample before [s].
  double z = 0.0;   ///< Altitude, NED [m].
  Attitude truth;
  bool rests = false, turns = false;
};

struct TurnCourse {
  double radius = 1.5;  ///< [m]
  double speed = 1.6;   ///< [m/s]
  int turns = 1;        ///< Turns of 180° with 1.5 s of straight flight between them, left, right.
  /// How far the drone is from the one that is known: none, race, hard.
  std::string level = "race";
};

/// Rest, speeding up, level coordinated turns: exact motion with drag, sensors of the simulator.
///
/// Drag, biases, scales and what appears in flight are drawn for the seed as for a race of that
/// level.
[[nodiscard]] std::vector<Moment> coordinated_turns(const TurnCourse& course, std::uint64_t seed);

// Corrections that gates would give: how often [s], height [m] and heading [rad] how well.
inline constexpr double kCorrections = 1.0 / 15, kTrialAltitudeSigma = 0.05,
                        kTrialHeadingSigma = 0.05;

}  // namespace gatefly::experiments
