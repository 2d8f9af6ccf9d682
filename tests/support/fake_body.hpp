// SPDX-License-Identifier: Apache-2.0
#pragma once

// A drone below a fake controller: it turns and lifts as it is told, a little late.
#include <algorithm>

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::test {

/// Rates and thrust follow what is wanted with a lag of 40 ms, air drags by 0.3 a second, the floor is at 0.
struct FakeBody {
  Quaternion q;
  Eigen::Vector3d p_E = Eigen::Vector3d::Zero(), v_E = Eigen::Vector3d::Zero(),
                  rates_B = Eigen::Vector3d::Zero(), accel_E = Eigen::Vector3d::Zero();
  double thrust = 0.0;  ///< Specific [m/s²].

  /// @param held  somebody holds it where it is.
  void step(const Eigen::Vector3d& wanted_rates_B, double wanted_thrust, bool held, double dt) {
    const double part = dt / 0.04;
    thrust += part * (wanted_thrust - thrust);
    rates_B += part * (wanted_rates_B - rates_B);
    accel_E = rotation_EB(q) * Eigen::Vector3d(0, 0, -thrust) + Eigen::Vector3d(0, 0, kGravity) -
              0.3 * v_E;
    const bool on_floor = p_E.z() >= 0 && accel_E.z() >= 0;
    if (held || on_floor) {
      accel_E.setZero(), v_E.setZero(), rates_B.setZero();
      q = quaternion_of(Attitude{0, 0, attitude_of(rotation_EB(q)).yaw});
      return;
    }
    q = integrated(q, rates_B, dt);
    v_E += dt * accel_E;
    p_E += dt * v_E;
    p_E.z() = std::min(0.0, p_E.z());
  }
  /// By hand, about an axis [rad/s].
  void turn(int axis, double rate, double dt) {
    accel_E.setZero(), rates_B.setZero();
    rates_B[axis] = rate;
    q = integrated(q, rates_B, dt);
  }
  /// Reading of an accelerometer.
  [[nodiscard]] Eigen::Vector3d force_B() const {
    return rotation_EB(q).inverse() * (accel_E - Eigen::Vector3d(0, 0, kGravity));
  }
};

}  // namespace gatefly::test
