// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/held_drone.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::link_sim {
namespace {

constexpr double kHeldAt = 1.0;      ///< Above the floor [m].
constexpr double kTurn = kPi / 3.0;  ///< Less than a quarter: there a pitch has no roll beside it.
constexpr double kThereAndBack = 2.0;  ///< [s]

}  // namespace

HeldDrone::HeldDrone(const world::SimConfig& config)
    : imu_model_{config.sensors, config.seed}, yaw_{config.start.heading} {
  state_.p_EB << config.start.position, -kHeldAt;
  state_.q_EB = sim::q_EB_of({0.0, 0.0, yaw_});
}

void HeldDrone::turn(int axis) {
  if (axis_ || axis < 0 || axis > 2) return;
  axis_ = axis;
  turned_for_ = 0.0;
}

void HeldDrone::step(double dt) {
  time_ += dt;
  Eigen::Vector3d angles{0.0, 0.0, yaw_};
  state_.rate_B.setZero();
  if (axis_) {
    turned_for_ += dt;
    const double phase = 2.0 * kPi * std::min(1.0, turned_for_ / kThereAndBack);
    angles[*axis_] += 0.5 * kTurn * (1.0 - cos(phase));
    // Level otherwise, so that it is a turn about the body's own axis.
    state_.rate_B[*axis_] = kPi / kThereAndBack * kTurn * sin(phase);
    if (turned_for_ >= kThereAndBack) axis_.reset();
  }
  state_.q_EB = sim::q_EB_of({angles.x(), angles.y(), angles.z()});
  state_.specific_force_B =
      sim::R_EB_of(state_.q_EB).transpose() * Eigen::Vector3d{0.0, 0.0, -kGravity};
  imu_ = imu_model_.measure(state_, dt);
}

betaflight_sitl::State HeldDrone::told() const {
  return {.time = std::chrono::nanoseconds{std::llround(1e9 * time_)},
          .imu = imu_,
          .p_EB = state_.p_EB,
          .v_E = state_.v_E,
          .attitude = attitude_of({sim::R_EB_of(state_.q_EB)})};
}

}  // namespace gatefly::link_sim
