// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/attitude.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "gatefly/geometry/math.hpp"

namespace gatefly {

Eigen::Matrix3d rotation_x(double angle) {
  const auto [s, c] = sincos(angle);
  Eigen::Matrix3d R;
  R << 1, 0, 0, 0, c, -s, 0, s, c;
  return R;
}

Eigen::Matrix3d rotation_y(double angle) {
  const auto [s, c] = sincos(angle);
  Eigen::Matrix3d R;
  R << c, 0, s, 0, 1, 0, -s, 0, c;
  return R;
}

Eigen::Matrix3d rotation_z(double angle) {
  const auto [s, c] = sincos(angle);
  Eigen::Matrix3d R;
  R << c, -s, 0, s, c, 0, 0, 0, 1;
  return R;
}

RotationEB rotation_EB(const Attitude& attitude) {
  return {rotation_z(attitude.yaw) * rotation_y(attitude.pitch) * rotation_x(attitude.roll)};
}

Attitude attitude_of(const RotationEB& R_EB) {
  const Eigen::Matrix3d& R = R_EB.matrix;
  const double cos_pitch = std::sqrt(R(2, 1) * R(2, 1) + R(2, 2) * R(2, 2));
  const double pitch = atan2(-R(2, 0), cos_pitch);
  // Gimbal lock: only yaw - roll is defined; all of it goes to yaw.
  if (cos_pitch < 1e-9) return {0.0, pitch, atan2(-R(0, 1), R(1, 1))};
  return {atan2(R(2, 1), R(2, 2)), pitch, atan2(R(1, 0), R(0, 0))};
}

Quaternion quaternion_of(const Attitude& attitude) {
  const auto [sr, cr] = sincos(attitude.roll / 2);
  const auto [sp, cp] = sincos(attitude.pitch / 2);
  const auto [sy, cy] = sincos(attitude.yaw / 2);
  return {cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
          cr * cp * sy - sr * sp * cy};
}

RotationEB rotation_EB(const Quaternion& q) {
  return {Eigen::Quaterniond{q.w, q.x, q.y, q.z}.toRotationMatrix()};
}

Quaternion integrated(const Quaternion& q, const Eigen::Vector3d& rate_B, double dt) {
  const Eigen::Vector3d half = 0.5 * dt * rate_B;
  const double angle = half.norm();
  const auto [s, c] = sincos(angle);
  const Eigen::Vector3d v = half * (angle > 1e-12 ? s / angle : 1.0);
  const Eigen::Quaterniond next =
      (Eigen::Quaterniond{q.w, q.x, q.y, q.z} * Eigen::Quaterniond{c, v.x(), v.y(), v.z()})
          .normalized();
  return {next.w(), next.x(), next.y(), next.z()};
}

RotationBC camera_mount(double tilt_down, double roll) {
  // Camera axes (right, down, forward) of a level camera, as columns in the body frame.
  Eigen::Matrix3d R_level;
  R_level << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return {rotation_y(-tilt_down) * R_level * rotation_z(roll)};
}

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d S;
  S << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return S;
}

}  // namespace gatefly
