// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace gatefly {

/// One IMU sample, body frame (front, right, down).
struct Imu {
  Eigen::Vector3d gyro_B = Eigen::Vector3d::Zero();  ///< p, q, r [rad/s]
  /// Specific force [m/s²]; (0, 0, -g) at rest.
  Eigen::Vector3d accel_B = Eigen::Vector3d::Zero();
};

}  // namespace gatefly
