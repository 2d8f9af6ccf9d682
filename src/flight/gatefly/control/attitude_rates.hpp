// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "gatefly/control/attitude_command.hpp"
#include "gatefly/control/control_params.hpp"
#include "gatefly/geometry/frames.hpp"

namespace gatefly {

/// Turn rates that bring the attitude to a command, for an autopilot that holds rates and obeys late.
///
/// Ours; a Smith predictor (Smith 1957) on a first-order answer: what has been asked for and cannot have
/// shown yet is added to the attitude before the error is taken, so that a delay does not ring. The
/// error is split into tilt and yaw (reduced attitude, Brescianini and D'Andrea 2018): the thrust points
/// where it is told before the nose does.
class AttitudeRates {
 public:
  explicit AttitudeRates(const RateParams& params, double max_yaw_rate)
      : params_{params}, max_yaw_rate_{max_yaw_rate} {}
  void reset() { obeyed_.setZero(); }

  /// @return rates about front, right, down [rad/s].
  Eigen::Vector3d step(const AttitudeCommand& command, const RotationEB& R_EB, double dt);

 private:
  RateParams params_;
  double max_yaw_rate_;
  Eigen::Vector3d obeyed_ = Eigen::Vector3d::Zero();  ///< Rates by now, by the model [rad/s].
};

/// The speed at which four rotors give `thrust` [m/s²], each: within the vehicle's limits [rad/s].
[[nodiscard]] std::array<double, 4> speeds_for(double thrust, const VehicleParams& vehicle);

}  // namespace gatefly
