// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sensing/imu.hpp"

namespace gatefly::baseline {

struct MahonyParams {
  double kp = 0.5;  ///< How fast the tilt follows the accelerometer [1/s].
  double ki = 0.0;  ///< How fast the gyro's bias is learnt [1/s²].
};

/// The plain complementary filter: whatever the accelerometer reads is taken for gravity. Mahony et
/// al. 2008, explicit filter.
class Mahony {
 public:
  explicit Mahony(const MahonyParams& params = {}) : params_{params} {}

  void start(const Attitude& attitude);

  /// dt <= 0 changes nothing; a specific force of zero corrects nothing.
  void update(const Imu& imu, double dt);

  [[nodiscard]] RotationEB R_EB() const { return rotation_EB(q_); }
  [[nodiscard]] Attitude attitude() const { return attitude_of(R_EB()); }
  [[nodiscard]] const Eigen::Vector3d& gyro_bias() const { return gyro_bias_; }

 private:
  MahonyParams params_;
  Quaternion q_;
  Eigen::Vector3d gyro_bias_ = Eigen::Vector3d::Zero();
};

}  // namespace gatefly::baseline
