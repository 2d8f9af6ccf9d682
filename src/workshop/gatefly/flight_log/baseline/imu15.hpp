// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sensing/imu.hpp"

namespace gatefly::baseline {

struct Imu15Params {
  double accel_noise = 0.1;  ///< [m/s²/√Hz]
  /// [rad/s/√Hz; accelerometer and gyro: of .03, .1, .3, 1 and .002, .007, .02, .05 the least drift
  /// on real flights]
  double gyro_noise = 0.02;
  double accel_walk =
      0.014;  ///< Random walk of the bias [m/s²/√s]; its square is the drag filter's.
  double gyro_walk = 2e-4;    ///< Random walk of the bias [rad/s/√s]
  double gravity = kGravity;  ///< [m/s²]
  /// [m]; as the drag filter's, and so is the bias's
  Eigen::Vector3d start_position_sigma{0.15, 0.15, 0.05};
  Eigen::Vector3d start_bias_sigma{0.15, 0.15, 0.30};  ///< [m/s²]
  double start_velocity_sigma = 0.1;                   ///< [m/s]
  /// [rad], [rad], [rad/s]
  double start_tilt_sigma = 0.03, start_heading_sigma = 0.02, start_gyro_sigma = 0.01;
};

/// The classic error-state Kalman filter: position, velocity, attitude, accelerometer and gyro
/// biases.
///
/// Velocity is integrated acceleration, so what is wrong with tilt or bias integrates twice. Errors
/// of attitude are in the earth frame, R = exp([θ]×) R̂. [Solà 2017, "Quaternion kinematics",
/// global errors]
class Imu15 {
 public:
  static constexpr int kStates = 15;
  using State = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;
  enum Index : int { kP = 0, kV = 3, kTheta = 6, kAccelBias = 9, kGyroBias = 12 };

  explicit Imu15(const Imu15Params& params) : params_{params} {}

  /// At rest. Earth frame, NED.
  void start(const Eigen::Vector3d& p_EB, const Attitude& attitude,
             const Eigen::Vector3d& accel_bias, const Eigen::Vector3d& gyro_bias);

  /// dt <= 0 changes nothing.
  void predict(const Imu& imu, double dt);

  void correct_position(const Eigen::Vector3d& p_EB, const Eigen::Vector3d& sigma);
  void correct_altitude(double z, double sigma);
  void correct_heading(double yaw, double sigma);

  [[nodiscard]] const Eigen::Vector3d& position() const { return p_; }
  [[nodiscard]] const Eigen::Vector3d& velocity() const { return v_; }
  [[nodiscard]] Attitude attitude() const { return attitude_of(rotation_EB(q_)); }
  [[nodiscard]] const Eigen::Vector3d& accel_bias() const { return accel_bias_; }
  [[nodiscard]] const Eigen::Vector3d& gyro_bias() const { return gyro_bias_; }
  [[nodiscard]] const Covariance& covariance() const { return P_; }

 private:
  // Takes one measurement, z = Hᵀ x.
  void correct(double innovation, const State& H, double sigma);

  Imu15Params params_;
  Eigen::Vector3d p_ = Eigen::Vector3d::Zero(), v_ = Eigen::Vector3d::Zero();
  Quaternion q_;
  Eigen::Vector3d accel_bias_ = Eigen::Vector3d::Zero(), gyro_bias_ = Eigen::Vector3d::Zero();
  Covariance P_ = Covariance::Identity();
};

}  // namespace gatefly::baseline
