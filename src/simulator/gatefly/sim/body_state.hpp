// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {

/// The body's true motion, earth frame NED and body frame FRD.
struct BodyState {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_E = Eigen::Vector3d::Zero();
  Eigen::Vector4d q_EB{1, 0, 0, 0};  ///< w, x, y, z
  Eigen::Vector3d rate_B = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_B{0, 0, -kGravity};  ///< An ideal accelerometer [m/s²].
  std::array<double, 4> rotor_speed{};                ///< [rad/s]
  Eigen::Vector3d wind_E{0, 0, 0};                    ///< The air around it [m/s].
};

/// Orientation from a quaternion w, x, y, z, and back.
[[nodiscard]] inline Eigen::Matrix3d R_EB_of(const Eigen::Vector4d& q_EB) {
  return rotation_EB(Quaternion{q_EB(0), q_EB(1), q_EB(2), q_EB(3)}).matrix;
}
[[nodiscard]] inline Eigen::Vector4d q_EB_of(const Attitude& attitude) {
  const Quaternion q = quaternion_of(attitude);
  return {q.w, q.x, q.y, q.z};
}

}  // namespace gatefly::sim
