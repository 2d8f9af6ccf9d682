// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/flight_log/baseline/imu15.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly::flight_log {

/// The classic inertial filter beside a pilot: the same IMU, heights and fixes, another estimate.
/// For comparison.
class InertialFollower {
 public:
  explicit InertialFollower(const baseline::Imu15Params& params = {}) : filter_{params} {}

  /// After pilot.step(sensors). Starts from what the pilot believes when the motors start.
  void update(const Sensors& sensors, const Pilot& pilot);

  /// The pilot's estimate with position, velocity, attitude and biases of this filter in their
  /// place.
  [[nodiscard]] Estimate estimate(const Pilot& pilot) const;

 private:
  baseline::Imu15 filter_;
  bool started_ = false;
  double time_ = 0.0;
};

}  // namespace gatefly::flight_log
