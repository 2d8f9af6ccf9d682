// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "gatefly/estimation/drag_model.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rng.hpp"

namespace gatefly::test {

/// Standard normal number (Box-Muller), the same on every machine that has IEEE log and sqrt.
inline double normal(Rng& rng) {
  const double u = 1.0 - rng.uniform(0.0, 1.0);
  return std::sqrt(-2.0 * std::log(u)) * gatefly::cos(rng.uniform(0.0, 2.0 * kPi));
}

inline Eigen::Vector2d any_vector2(Rng& rng, double size) {
  const double x = rng.uniform(-size, size);
  const double y = rng.uniform(-size, size);
  return {x, y};
}

inline Eigen::Vector3d any_vector3(Rng& rng, double size) {
  const double x = rng.uniform(-size, size);
  const double y = rng.uniform(-size, size);
  const double z = rng.uniform(-size, size);
  return {x, y, z};
}

/// Any direction, evenly over the sphere.
inline Eigen::Vector3d any_direction(Rng& rng) {
  for (;;) {
    const Eigen::Vector3d v = any_vector3(rng, 1.0);
    if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
  }
}

/// Roll and pitch up to `tilt`, any heading [rad].
inline Attitude any_attitude(Rng& rng, double tilt = 0.6) {
  Attitude a;
  a.roll = rng.uniform(-tilt, tilt);
  a.pitch = rng.uniform(-tilt, tilt);
  a.yaw = rng.uniform(-kPi, kPi);
  return a;
}

inline drag_model::State any_state(Rng& rng) {
  drag_model::State x;
  x << any_vector3(rng, 5.0), rng.uniform(-1.5, 1.5), any_vector3(rng, 0.5);
  return x;
}

inline drag_model::Input any_input(Rng& rng) {
  const Attitude a = any_attitude(rng, 0.8);
  drag_model::Input u;
  u.roll = a.roll, u.pitch = a.pitch, u.yaw = a.yaw;
  u.accel_B = any_vector3(rng, 2.0) - Eigen::Vector3d{0, 0, 9.81};
  u.gyro_B = any_vector3(rng, 3.0);
  return u;
}

}  // namespace gatefly::test
