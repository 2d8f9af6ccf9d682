// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sensing/imu.hpp"

namespace gatefly {

struct AhrsParams {
  /// Natural frequency of the gravity correction [rad/s]. [Li18 code: 0.063]
  double omega = 0.20;
  double zeta = 0.9;  ///< [Li18 flight code]
  /// Weight 1 − factor·(|‖f‖ − g| + ‖v̇‖)/(10 g), of averages. [Li18 code: no v̇]
  double gravity_factor = 30.0;
  double min_weight = 0.15;  ///< [Li18 flight code]
  /// The specific force is averaged over this, in the earth frame [s]. [estimate]
  double gravity_time = 0.5;
  double tilt_process = 3e-3;  ///< Growth of the tilt's standard deviation [rad/√s]. [estimate]
  double gyro_delay = 2.5e-3;  ///< Age of a rate: for the uncertainty only [s]. [BROAD: 2.4 ms]
  /// Accelerometer bias that the rest calibration does not show [m/s²]. [estimate]
  double accel_bias_sigma = 0.08;
  /// Below this rate, low-passed, the drone may be at rest [rad/s]. [estimate]
  double rest_gyro = 0.15;
  /// Below this deviation from the mean so far it may be at rest [m/s²]. [estimate]
  double rest_accel = 2.5;
  double rest_time = 0.0625;      ///< Averages that say whether it rests [s]. [estimate]
  double imu_hz = 512.0;          ///< Nominal rate of the samples. [Li18 flight code]
  double gravity = 9.81;          ///< [m/s²]
  double heading_process = 4e-3;  ///< Growth of the heading's σ [rad/√s]. [estimate]
  /// Relative error of the yaw gyro's scale; the heading's error grows with the angle turned. [ours: estimate]
  double scale_sigma = 0.01;
  double bias_process = 2e-4;         ///< The same for the yaw gyro's bias [rad/s/√s]. [estimate]
  double start_heading_sigma = 0.06;  ///< How well the pad's heading is known [rad]. [ours: 3°]
};

/// Attitude from gyro and gravity: a complementary filter on the quaternion. Euston et al. 2008,
/// Li18 §2.
///
/// Differs: the specific force is freed from its bias at rest and from the change of the velocity
/// that drag shows (a turn, braking), and averaged in the earth frame, where all shaking is about
/// zero [Laidig & Seel 2022]; its uncertainty is estimated; gyro biases are learnt at rest; heading, which
/// gravity cannot see, is corrected by sightings of gates through a two-state Kalman filter
/// (heading, yaw gyro bias) (docs/paper/deviations.md#ahrs).
class Ahrs {
 public:
  explicit Ahrs(const AhrsParams& params) : params_{params} {}

  /// Starts at a known heading, level until told otherwise.
  void start(double yaw);

  /// The drone stands still on a level pad: one sample for gyro and accelerometer bias.
  /// A sample that moves (hands on the drone) is left out.
  void update_at_rest(const Imu& imu);

  /// One step in flight.
  /// @param v_B  velocity as the filter sees it; its change is no gravity [m/s]. Unknown: zero.
  void update(const Imu& imu, const Eigen::Vector3d& v_B, double dt);

  /// A gate says the heading is off by `error` [rad]. Used only when within 4 σ.
  void correct_heading(double error, double variance);

  /// Attitude from outside (a log's own), where the question is not attitude.
  void set(const Attitude& attitude);

  [[nodiscard]] RotationEB R_EB() const { return rotation_EB(q_); }
  [[nodiscard]] Attitude attitude() const { return attitude_of(R_EB()); }
  /// Bias removed [rad/s].
  [[nodiscard]] const Eigen::Vector3d& rate_B() const { return rate_B_; }
  [[nodiscard]] const Eigen::Vector3d& gyro_bias() const { return gyro_bias_; }
  /// Mean specific force at rest plus gravity: the accelerometer's bias on a level pad [m/s²].
  [[nodiscard]] const Eigen::Vector3d& accel_bias() const { return accel_bias_; }
  [[nodiscard]] int rest_samples() const { return rest_samples_; }
  [[nodiscard]] double heading_sigma() const;
  /// Standard deviation of roll and of pitch [rad]. Widens with rotation and with what moves the
  /// specific force.
  [[nodiscard]] double tilt_sigma() const;

 private:
  AhrsParams params_;
  Quaternion q_;
  Eigen::Vector3d rate_B_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_bias_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d slow_gyro_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d slow_accel_ = Eigen::Vector3d::Zero();
  int rest_samples_ = 0;
  // averages
  Eigen::Vector3d force_E_ = Eigen::Vector3d::Zero(), accel_E_ = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> v_E_;
  double tilt_P_ = 0.0;
  Eigen::Matrix2d P_ = Eigen::Matrix2d::Identity() * 1e-4;  // heading error, yaw gyro bias
};

}  // namespace gatefly
