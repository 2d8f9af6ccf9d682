// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/experiments/experiment.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sensing/imu.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::experiments {

/// One IMU sample of a flight and what was asked of it.
struct LivelySample {
  double t = 0.0, dt = 0.0;  ///< [s]
  Imu imu;
  Attitude attitude, wanted;                      ///< The autopilot's own, and its set point.
  Eigen::Vector3d p_E = Eigen::Vector3d::Zero();  ///< By motion capture, held until the next.
  Eigen::Vector3d v_E = Eigen::Vector3d::Zero();  ///< [m/s]
  std::array<double, 4> rotor_wanted{}, rotor{};  ///< Asked for and reported [rad/s].
};

/// A flight by its log: a real one, or the simulated one that was given the same set points.
struct LivelyFlight {
  std::string name;
  std::vector<LivelySample> samples = {};
  std::size_t first = 0, last = 0;  ///< In the air: above 0.9 m until it comes down to 0.6 m.
  double heading_offset = 0.0;      ///< To add to the log's heading to be in E [rad].

  /// Velocity along the nose, to the right, down [m/s].
  [[nodiscard]] Eigen::Vector3d v_B(std::size_t i) const;
};

/// Real flights flight_*, in the order of their names, with heading offsets as the drag fit finds
/// them. @throws std::runtime_error: no such folder, a log without set points or rotor speeds.
[[nodiscard]] std::vector<LivelyFlight> lively_flights(const std::filesystem::path& folder,
                                                       const Options& options);

/// The same set points of roll, pitch, heading and height, at the same times, given to a simulated
/// drone under the autopilot that flew the log, as the log shows it: nothing of our pilot.
/// @param config  drawn truth; its start and room are of no account.
[[nodiscard]] LivelyFlight flown_again(const LivelyFlight& real, world::SimConfig config);

}  // namespace gatefly::experiments
