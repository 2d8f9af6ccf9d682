// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/ahrs.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly {

void Ahrs::start(double yaw) {
  *this = Ahrs{params_};
  set({0.0, 0.0, yaw});
  const double rest_bias_sigma = 0.004;  // of a 1 s mean, with what warms up afterwards [rad/s]
  P_ << params_.start_heading_sigma * params_.start_heading_sigma, 0, 0,
      rest_bias_sigma * rest_bias_sigma;
}

void Ahrs::set(const Attitude& attitude) {
  q_ = quaternion_of(attitude);
  force_E_ = {0.0, 0.0, -params_.gravity};
  accel_E_.setZero();
  v_E_.reset();
}

void Ahrs::update_at_rest(const Imu& imu) {
  const Eigen::Vector3d accel = imu.accel_B + Eigen::Vector3d{0, 0, params_.gravity};
  if (rest_samples_ == 0) {
    slow_gyro_ = Eigen::Vector3d::Zero();
    slow_accel_ = accel;
  }
  const double part = std::min(1.0, 1.0 / (params_.rest_time * params_.imu_hz));
  slow_gyro_ += part * (imu.gyro_B - slow_gyro_);
  slow_accel_ += part * (accel - slow_accel_);
  ++rest_samples_;
  if (slow_gyro_.norm() > params_.rest_gyro ||
      (slow_accel_ - accel_bias_).norm() > params_.rest_accel) {
    rest_samples_ = 0;  // moved: begin again
    gyro_bias_.setZero();
    accel_bias_.setZero();
    return;
  }
  const double weight = 1.0 / rest_samples_;
  gyro_bias_ += weight * (imu.gyro_B - gyro_bias_);
  accel_bias_ += weight * (accel - accel_bias_);
}

void Ahrs::update(const Imu& imu, const Eigen::Vector3d& v_B, double dt) {
  rate_B_ = imu.gyro_B - gyro_bias_;
  q_ = integrated(q_, rate_B_, dt);
  const Eigen::Matrix3d R = R_EB().matrix;

  // f = a − g: what the average of f keeps without that of v̇ points up.
  const Eigen::Vector3d v_E = R * v_B;
  const double g = params_.gravity, time = params_.gravity_time, part = std::min(1.0, dt / time);
  force_E_ += part * (R * (imu.accel_B - accel_bias_) - force_E_);
  accel_E_ += (v_E - v_E_.value_or(v_E)) / time - part * accel_E_;
  v_E_ = v_E;
  const Eigen::Vector3d up_E = force_E_ - accel_E_;

  // Drag shows only a part of the velocity: the more it changes, the less weight gravity gets.
  const double off = (std::abs(up_E.norm() - g) + accel_E_.norm()) / g;
  const double weight =
      std::clamp(1.0 - params_.gravity_factor * off / 10.0, params_.min_weight, 1.0);
  const Eigen::Vector3d error_B = R.transpose() * Eigen::Vector3d{-up_E.y(), up_E.x(), 0.0} / g;
  Eigen::Vector3d bias_step = weight * params_.omega * params_.omega * dt * error_B;
  bias_step.z() = 0.0;  // the yaw gyro's bias belongs to the heading filter
  gyro_bias_ -= bias_step;
  const double gain = weight * 2.0 * params_.zeta * params_.omega;
  q_ = integrated(q_, gain * error_B, dt);

  // Tilt: Ṗ = −2kP + k²S + Q; what the average is off by is noise that lasts as long as the
  // average.
  const double S =
      2.0 * params_.gravity_time * (up_E / g + Eigen::Vector3d::UnitZ()).squaredNorm() / 3.0;
  tilt_P_ += dt * (gain * gain * S + params_.tilt_process * params_.tilt_process);
  tilt_P_ /= 1.0 + 2.0 * gain * dt;

  // Heading filter: ψ̇ error = −bias error.
  P_(0, 0) += dt * (-2.0 * P_(0, 1) + dt * P_(1, 1)) +
              params_.heading_process * params_.heading_process * dt;
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
  if (v_E_) v_E_ = rotation_z(K(0) * error) * *v_E_;  // the past was off by as much
  gyro_bias_.z() += K(1) * error;
  P_ -= K * P_.row(0).eval();
  P_(0, 1) = P_(1, 0) = 0.5 * (P_(0, 1) + P_(1, 0));
}

double Ahrs::heading_sigma() const { return std::sqrt(P_(0, 0)); }

double Ahrs::tilt_sigma() const {
  const double level = params_.accel_bias_sigma / params_.gravity,
               late = params_.gyro_delay * rate_B_.head<2>().norm();
  return std::sqrt(tilt_P_ + level * level + 0.5 * late * late);
}

}  // namespace gatefly
