// SPDX-License-Identifier: Apache-2.0
#include "gatefly/control/indi.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "gatefly/control/attitude_error.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {

Indi::Indi(const IndiParams& params, const VehicleParams& vehicle)
    : params_{params},
      vehicle_{vehicle},
      rate_filter_{params.filter_hz, params.sample_hz, params.filter_damping},
      actuator_filter_{params.filter_hz, params.sample_hz, params.filter_damping} {
  // Columns: left front, right front, right back, left back. A rotor on the right (y > 0) rolls
  // left.
  const double lx = vehicle.arm_x, ly = vehicle.arm_y, c = vehicle.torque_coefficient;
  effect_ << ly, -ly, -ly, ly,  //
      lx, lx, -lx, -lx,         //
      -c, c, -c, c,             //
      1, 1, 1, 1;
  effect_.topRows<3>() = vehicle.inertia.cwiseInverse().asDiagonal() * effect_.topRows<3>().eval();
  effect_.row(3) /= vehicle.mass;
  allocation_ = effect_.inverse();
}

// LMS of Smeur et al. 2016, Eq. (24), normalised; a factor an axis in place of a matrix: the rotors
// are alike, what is off are the inertia and the arms.
void Indi::adapt(const Eigen::Vector3d& accel, const Eigen::Vector3d& produced) {
  const Eigen::Array3d got = accel - last_accel_, meant = produced - last_produced_;
  last_accel_ = accel;
  last_produced_ = produced;
  const Eigen::Array3d missing = got - effectiveness_.array() * meant;
  const double floor2 = params_.adaptation_floor * params_.adaptation_floor;
  effectiveness_.array() += params_.adaptation * missing * meant / (meant.square() + floor2);
  effectiveness_ = effectiveness_.cwiseMax(1.0 / params_.max_effectiveness_ratio)
                       .cwiseMin(params_.max_effectiveness_ratio);
}

void Indi::reset() { *this = Indi{params_, vehicle_}; }

std::array<double, 4> Indi::step(const AttitudeCommand& command, const RotationEB& R_EB,
                                 const Eigen::Vector3d& rate_B, double dt) {
  if (!(dt > 0.0)) dt = 1.0 / params_.sample_hz;

  // Measured: filtered rate and its derivative; and what the rotors did meanwhile, through the same
  // filter.
  const Eigen::Vector3d rate = rate_filter_.update(rate_B);
  const Eigen::Vector3d accel =
      started_ ? Eigen::Vector3d{(rate - last_rate_) / dt} : Eigen::Vector3d::Zero();
  last_rate_ = rate;
  started_ = true;
  const Eigen::Vector3d produced = actuator_filter_.update(effect_of(rotor_thrusts_).head<3>());

  if (params_.adaptive) adapt(accel, produced);

  // Wanted: a second-order response of the error rotation, split into tilt and heading.
  const Eigen::Matrix3d R_wanted =
      rotation_EB(Attitude{command.roll, command.pitch, command.yaw}).matrix;
  const Eigen::Matrix3d E = R_EB.matrix.transpose() * R_wanted;
  const Eigen::Vector3d error = tilt_then_yaw(E);
  const Eigen::Vector3d rate_wanted =
      R_EB.matrix.transpose() * Eigen::Vector3d{0, 0, command.yaw_rate};
  const double yaw_rate =
      std::clamp(rate_wanted.z() + params_.yaw_attitude_gain / params_.yaw_rate_gain * error.z(),
                 -params_.max_yaw_rate, params_.max_yaw_rate);
  Eigen::Vector3d wanted;
  wanted.x() =
      params_.attitude_gain * error.x() + params_.rate_gain * (rate_wanted.x() - rate_B.x());
  wanted.y() =
      params_.attitude_gain * error.y() + params_.rate_gain * (rate_wanted.y() - rate_B.y());
  wanted.z() = params_.yaw_rate_gain * (yaw_rate - rate_B.z());

  // Increment, then allocate; heading gives way first when a rotor is at its limit.
  Eigen::Vector4d target;
  target.head<3>() = produced + (wanted - accel).cwiseQuotient(effectiveness_);
  target(3) = std::clamp(command.thrust, 2.0, 25.0);
  const double k = vehicle_.thrust_coefficient;
  const double low = k * vehicle_.min_speed * vehicle_.min_speed,
               high = k * vehicle_.max_speed * vehicle_.max_speed;
  Eigen::Vector4d thrusts = allocation_ * target;
  if (thrusts.minCoeff() < low || thrusts.maxCoeff() > high) {
    target(2) = 0.3 * target(2);
    thrusts = allocation_ * target;
  }
  thrusts = thrusts.cwiseMax(low).cwiseMin(high);

  const double lag = std::min(1.0, dt / vehicle_.rotor_time_constant);
  rotor_thrusts_ += lag * (thrusts - rotor_thrusts_);
  std::array<double, 4> speeds{};
  for (int i = 0; i < 4; ++i) speeds[static_cast<std::size_t>(i)] = std::sqrt(thrusts(i) / k);
  return speeds;
}

}  // namespace gatefly
