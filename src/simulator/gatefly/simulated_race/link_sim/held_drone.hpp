// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/link/betaflight_sitl.hpp"
#include "gatefly/sensing/imu.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/sensors.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::link_sim {

/// A drone in somebody's hand, propellers off: level and still, or being turned about one of its axes and back. What its motors do
/// moves nothing.
class HeldDrone {
 public:
  explicit HeldDrone(const world::SimConfig& config);

  /// Begins a turn about front (0), right (1) or down (2), and back, in two seconds; one that goes on is left alone.
  void turn(int axis);
  [[nodiscard]] bool turns() const { return axis_.has_value(); }

  /// Another `dt` [s].
  void step(double dt);
  /// The state that a flight controller's simulator is told.
  [[nodiscard]] betaflight_sitl::State told() const;
  [[nodiscard]] const sim::BodyState& state() const { return state_; }
  [[nodiscard]] double time() const { return time_; }

 private:
  sim::ImuModel imu_model_;
  sim::BodyState state_;
  Imu imu_;
  double time_ = 0.0, yaw_, turned_for_ = 0.0;
  std::optional<int> axis_;
};

}  // namespace gatefly::link_sim
