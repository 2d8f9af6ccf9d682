// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/baseline/imu15.hpp"

#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly::baseline {

void Imu15::start(const Eigen::Vector3d& p_EB, const Attitude& attitude,
                  const Eigen::Vector3d& accel_bias, const Eigen::Vector3d& gyro_bias) {
  p_ = p_EB, v_.setZero(), q_ = quaternion_of(attitude), accel_bias_ = accel_bias,
  gyro_bias_ = gyro_bias;
  P_.setZero();
  P_.diagonal().segment<3>(kP) = params_.start_position_sigma.cwiseAbs2();
  P_.diagonal().segment<3>(kV).setConstant(params_.start_velocity_sigma *
                                           params_.start_velocity_sigma);
  P_.diagonal().segment<3>(kTheta) =
      Eigen::Vector3d{params_.start_tilt_sigma, params_.start_tilt_sigma,
                      params_.start_heading_sigma}
          .cwiseAbs2();
  P_.diagonal().segment<3>(kAccelBias) = params_.start_bias_sigma.cwiseAbs2();
  P_.diagonal().segment<3>(kGyroBias).setConstant(params_.start_gyro_sigma *
                                                  params_.start_gyro_sigma);
}

void Imu15::predict(const Imu& imu, double dt) {
  if (!(dt > 0.0) || dt > 1.0 || !imu.accel_B.allFinite() || !imu.gyro_B.allFinite()) return;
  const Eigen::Matrix3d R = rotation_EB(q_).matrix;
  const Eigen::Vector3d force_E = R * (imu.accel_B - accel_bias_);
  const Eigen::Vector3d accel_E = force_E + Eigen::Vector3d{0, 0, params_.gravity};
  p_ += dt * v_ + 0.5 * dt * dt * accel_E;
  v_ += dt * accel_E;
  q_ = integrated(q_, imu.gyro_B - gyro_bias_, dt);

  Covariance Phi = Covariance::Identity();
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  Phi.block<3, 3>(kP, kV) = dt * I;
  Phi.block<3, 3>(kP, kTheta) = -0.5 * dt * dt * skew(force_E);
  Phi.block<3, 3>(kP, kAccelBias) = -0.5 * dt * dt * R;
  Phi.block<3, 3>(kV, kTheta) = -dt * skew(force_E);
  Phi.block<3, 3>(kV, kAccelBias) = -dt * R;
  Phi.block<3, 3>(kTheta, kGyroBias) = -dt * R;
  // Φ P Φᵀ, twice the same product: P is symmetric.
  const Covariance half = Phi.lazyProduct(P_);
  Covariance P = Phi.lazyProduct(Covariance{half.transpose()});
  const auto add = [&](int at, double density) {
    P.diagonal().segment<3>(at).array() += density * density * dt;
  };
  add(kV, params_.accel_noise), add(kTheta, params_.gyro_noise),
      add(kAccelBias, params_.accel_walk), add(kGyroBias, params_.gyro_walk);
  P_ = 0.5 * (P + P.transpose());
}

void Imu15::correct(double innovation, const State& H, double sigma) {
  if (!std::isfinite(innovation)) return;
  const State PHt = P_ * H;
  const double variance = H.dot(PHt) + sigma * sigma;
  if (!(variance > 0.0)) return;  // already known exactly
  const State K = PHt / variance, error = K * innovation;
  P_ -= K * PHt.transpose();
  p_ += error.segment<3>(kP), v_ += error.segment<3>(kV);
  accel_bias_ += error.segment<3>(kAccelBias), gyro_bias_ += error.segment<3>(kGyroBias);
  // The attitude's error is a small turn in the earth frame: the same turn in the body's.
  const Eigen::Vector3d turn_B = rotation_EB(q_).matrix.transpose() * error.segment<3>(kTheta);
  q_ = integrated(q_, turn_B, 1.0);
}

// Errors of the three are independent: one after the other is all at once.
void Imu15::correct_position(const Eigen::Vector3d& p_EB, const Eigen::Vector3d& sigma) {
  if (!p_EB.allFinite()) return;
  for (int i = 0; i < 3; ++i) correct(p_EB(i) - p_(i), State::Unit(kP + i), sigma(i));
}

void Imu15::correct_altitude(double z, double sigma) {
  correct(z - p_.z(), State::Unit(kP + 2), sigma);
}

void Imu15::correct_heading(double yaw, double sigma) {
  // ψ = atan2(R10, R00): dψ/dθ of a small turn in the earth frame.
  const Eigen::Matrix3d R = rotation_EB(q_).matrix;
  const double level2 = R(0, 0) * R(0, 0) + R(1, 0) * R(1, 0);
  if (level2 < 1e-6) return;
  State H = State::Zero();
  H.segment<3>(kTheta) = Eigen::Vector3d{-R(0, 0) * R(2, 0), -R(1, 0) * R(2, 0), level2} / level2;
  correct(wrap_angle(yaw - attitude().yaw), H, sigma);
}

}  // namespace gatefly::baseline
