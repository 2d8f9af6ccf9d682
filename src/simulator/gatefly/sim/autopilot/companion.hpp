// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "gatefly/sim/autopilot/autopilot.hpp"
#include "gatefly/sim/late_line.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// A pilot's request to an autopilot, in SI units.
struct Wish {
  double roll = 0.0, pitch = 0.0;  ///< [rad]
  Eigen::Vector3d rates_B =
      Eigen::Vector3d::Zero();  ///< With angles the yaw's alone counts [rad/s].
  double rotor_speed =
      0.0;  ///< Speed of each rotor that gives the commanded thrust; 0: motors off [rad/s].
};

/// The companion's line to an autopilot: so many set points a second, each a little late, in order, as
/// sticks.
class Companion {
 public:
  /// @param max_rotor_speed  as the pilot believes it [rad/s].
  Companion(const world::AutopilotTruth& truth, double max_rotor_speed, std::uint64_t seed);

  /// Sends what the pilot wants now, when it is time to. @return what has arrived last.
  const SetPoint& pass_on(const Wish& wish, double time);

 private:
  [[nodiscard]] SetPoint set_point(const Wish& wish) const;

  world::AutopilotTruth truth_;
  StickCurves curves_;
  double max_rotor_speed_;
  LateLine<SetPoint> line_;
  SetPoint arrived_;
};

}  // namespace gatefly::sim
