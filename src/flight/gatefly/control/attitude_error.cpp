// SPDX-License-Identifier: Apache-2.0
#include "gatefly/control/attitude_error.hpp"

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly {

Eigen::Vector3d tilt_then_yaw(const Eigen::Matrix3d& E) {
  const Eigen::Vector2d level{-E(1, 2), E(0, 2)};
  const double sine = level.norm();
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();
  if (sine > 1e-9) tilt.head<2>() = atan2(sine, E(2, 2)) / sine * level;
  const Eigen::Matrix3d rest = rotation_of(tilt).transpose() * E;
  return {tilt.x(), tilt.y(), atan2(rest(1, 0), rest(0, 0))};
}

}  // namespace gatefly
