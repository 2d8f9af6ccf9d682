// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/estimation/eskf/state.hpp"

namespace gatefly::eskf {

/// The drone's motion since the last slow sample, for the control loop: turned by a fast gyro, the
/// specific force going on as it was.
///
/// Ours; sums as of Forster et al. 2017, which hold for any belief they begin at, so that a late
/// picture may change that. Nothing of it comes back into the filter.
class LookAhead {
 public:
  /// From now on, after a sample of `time` [s]. @param accel_B  bias removed [m/s²].
  void restart(const Eigen::Vector3d& accel_B, double time);
  /// Until `time` [s] at `rate_B`, bias removed [rad/s].
  void turn(const Eigen::Vector3d& rate_B, double time);
  /// A belief of the time of restart(), carried on.
  void carry(Nominal& x, double gravity) const;

 private:
  Eigen::Vector3d accel_B_ = Eigen::Vector3d::Zero(), rate_B_ = Eigen::Vector3d::Zero();
  double time_ = 0.0, passed_ = 0.0;  ///< [s]
  Eigen::Matrix3d turned_ = Eigen::Matrix3d::Identity();
  // The specific force has added these, in the axes of the beginning:
  Eigen::Vector3d speed_ = Eigen::Vector3d::Zero(), way_ = Eigen::Vector3d::Zero();
};

}  // namespace gatefly::eskf
