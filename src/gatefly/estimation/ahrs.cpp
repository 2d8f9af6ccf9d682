// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/ahrs.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly {

void Ahrs::start(double yaw) {
  *this = Ahrs{params_};
  q_ = quaternion_of({0.0, 0.0, yaw});
  const double rest_bias_sigma = 0.004;  // of a 1 s mean, with what warms up afterwards [rad/s]
  P_ << params_.start_heading_sigma * params_.start_heading_sigma, 0, 0, rest_bias_sigma * rest_bias_sigma;
}

void Ahrs::update_at_rest(const Imu& imu) {
  const Eigen::Vector3d accel = imu.accel_B + Eigen::Vector3d{0, 0, params_.gravity};
  if (rest_samples_ == 0) {
    slow_gyro_ = Eigen::Vector3d::Zero();
    slow_accel_ = accel;
  }
  constexpr double kSlow = 1.0 / 32;  // 60 ms at 512 Hz
  slow_gyro_ += kSlow * (imu.gyro_B - slow_gyro_);
  slow_accel_ += kSlow * (accel - slow_accel_);
  ++rest_samples_;
  if (slow_gyro_.norm() > params_.rest_gyro || (slow_accel_ - accel_bias_).norm() > params_.rest_accel) {
    rest_samples_ = 0;  // moved: begin again
    gyro_bias_.setZero();
    accel_bias_.setZero();
    return;
  }
  const double weight = 1.0 / rest_samples_;
  gyro_bias_ += weight * (imu.gyro_B - gyro_bias_);
  accel_bias_ += weight * (accel - accel_bias_);
}

void Ahrs::update(const Imu& imu, const Eigen::Vector3d& accel_B, const Eigen::Vector3d& v_B, double dt) {
  rate_B_ = imu.gyro_B - gyro_bias_;

  // What is left of the specific force without bias and turn points up: f = a − g, a ≈ ω × v.
  const Eigen::Vector3d f = accel_B - accel_bias_ - rate_B_.cross(v_B);
  const double norm = f.norm();
  Eigen::Vector3d correction = Eigen::Vector3d::Zero();
  if (norm > 0.5 * params_.gravity) {
    const Eigen::Vector3d up_measured = f / norm;
    const Eigen::Vector3d up_expected = R_EB().matrix.transpose() * Eigen::Vector3d{0, 0, -1};
    const double off = std::abs(norm - params_.gravity) / params_.gravity;
    const double weight = std::clamp(1.0 - params_.gravity_factor * off / 10.0, params_.min_weight, 1.0);
    const Eigen::Vector3d error = up_measured.cross(up_expected);
    correction = weight * 2.0 * params_.zeta * params_.omega * error;
    Eigen::Vector3d bias_step = weight * params_.omega * params_.omega * dt * error;
    bias_step.z() = 0.0;  // the yaw gyro's bias belongs to the heading filter
    gyro_bias_ -= bias_step;
  }
  q_ = integrated(q_, rate_B_ + correction, dt);

  // Heading filter: ψ̇ error = −bias error.
  P_(0, 0) += dt * (-2.0 * P_(0, 1) + dt * P_(1, 1)) + params_.heading_process * params_.heading_process * dt;
  P_(0, 0) += 2.0 * std::sqrt(P_(0, 0)) * params_.scale_sigma * std::abs(rate_B_.z()) * dt;
  P_(0, 1) -= dt * P_(1, 1);
  P_(1, 0) = P_(0, 1);
  P_(1, 1) += params_.bias_process * params_.bias_process * dt;
}

void Ahrs::correct_heading(double error, double variance) {
  const double S = P_(0, 0) + variance;
  if (!(variance > 0.0) || !(error * error < 16.0 * S)) return;
  const Eigen::Vector2d K = P_.col(0) / S;
  Attitude corrected = attitude();
  corrected.yaw += K(0) * error;
  q_ = quaternion_of(corrected);
  gyro_bias_.z() += K(1) * error;
  P_ -= K * P_.row(0).eval();
  P_(0, 1) = P_(1, 0) = 0.5 * (P_(0, 1) + P_(1, 0));
}

double Ahrs::heading_sigma() const { return std::sqrt(P_(0, 0)); }

}  // namespace gatefly
