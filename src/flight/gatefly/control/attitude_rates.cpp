// SPDX-License-Identifier: Apache-2.0
#include "gatefly/control/attitude_rates.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/control/attitude_error.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly {
Eigen::Vector3d AttitudeRates::step(const AttitudeCommand& command, const RotationEB& R_EB,
                                    double dt) {
  // Asked for and not obeyed yet: the integral of the difference, which of a first-order answer is
  // its time constant times what it has reached.
  const Eigen::Matrix3d R_then = R_EB.matrix * rotation_of(params_.response * obeyed_);
  const Eigen::Matrix3d R_wanted =
      rotation_EB(Attitude{command.roll, command.pitch, command.yaw}).matrix;
  const Eigen::Vector3d error = tilt_then_yaw(R_then.transpose() * R_wanted);
  const Eigen::Vector3d ahead = R_then.transpose() * Eigen::Vector3d{0, 0, command.yaw_rate};
  const Eigen::Vector3d most{params_.max_rate, params_.max_rate, max_yaw_rate_};
  const Eigen::Vector3d gain{params_.attitude_gain, params_.attitude_gain, params_.yaw_gain};
  const Eigen::Vector3d rates = (ahead + gain.cwiseProduct(error)).cwiseMax(-most).cwiseMin(most);
  obeyed_ += std::min(1.0, dt / params_.response) * (rates - obeyed_);
  return rates;
}

std::array<double, 4> speeds_for(double thrust, const VehicleParams& vehicle) {
  constexpr double kLeast = 2.0, kMost = 25.0;  // [m/s²]
  const double each = 0.25 * vehicle.mass * std::clamp(thrust, kLeast, kMost);
  const double speed = std::clamp(std::sqrt(each / vehicle.thrust_coefficient), vehicle.min_speed,
                                  vehicle.max_speed);
  return {speed, speed, speed, speed};
}

}  // namespace gatefly
