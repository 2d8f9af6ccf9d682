// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::experiments {

/// A race as `gatefly fly` makes it. @throws std::runtime_error as the files' readers.
/// @param laps  0: as many as the track says.
/// @param exact_map  the gates stand where the map says.
/// @param configs, settings  as --config and --set.
[[nodiscard]] simulated_race::RaceConfig race_on(const std::string& track, int laps,
                                                 simulated_race::Vision vision, std::uint64_t seed,
                                                 bool exact_map = false,
                                                 const std::vector<std::string>& configs = {},
                                                 const std::vector<std::string>& settings = {});

/// One IMU sample of a simulated flight.
struct LapMoment {
  Imu imu;
  double t = 0.0, dt = 0.0;                        ///< [s]
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();  ///< True [m].
  Eigen::Vector3d v_E = Eigen::Vector3d::Zero();   ///< True [m/s].
  Attitude attitude;                               ///< True.
  bool rests = false;                              ///< On the pad.
  /// A gate ahead could be seen: 0.5 to 4 m, within 25°.
  bool faces_gate = false;
};

/// Laps on ideal vision, flown by the pilot; what the drone's sensors said and where it really was.
struct SimulatedLaps {
  std::vector<LapMoment> moments;
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  ///< True, in flight [m/s²].
  bool finished = false;
};
[[nodiscard]] SimulatedLaps simulated_laps(const std::string& track, int laps, std::uint64_t seed);

}  // namespace gatefly::experiments
