// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/baseline/mahony.hpp"

namespace gatefly::baseline {

void Mahony::start(const Attitude& attitude) {
  q_ = quaternion_of(attitude);
  gyro_bias_.setZero();
}

void Mahony::update(const Imu& imu, double dt) {
  if (!(dt > 0.0)) return;
  const Eigen::Vector3d up_B = -R_EB().matrix.row(2).transpose();
  const double norm = imu.accel_B.norm();
  const Eigen::Vector3d error =
      norm > 0.0 ? (imu.accel_B / norm).cross(up_B).eval() : Eigen::Vector3d::Zero().eval();
  gyro_bias_ -= params_.ki * dt * error;
  q_ = integrated(q_, imu.gyro_B - gyro_bias_ + params_.kp * error, dt);
}

}  // namespace gatefly::baseline
