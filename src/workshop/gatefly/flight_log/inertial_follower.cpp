// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/inertial_follower.hpp"

#include <cmath>

#include "gatefly/geometry/seconds.hpp"

namespace gatefly::flight_log {

void InertialFollower::update(const Sensors& sensors, const Pilot& pilot) {
  const double now = seconds(sensors.time);
  const double dt = now - time_;
  time_ = now;
  if (std::holds_alternative<OnGround>(pilot.phase())) return;
  if (!started_) {
    const Estimate start = pilot.estimate();
    filter_.start(start.p_EB, start.attitude, start.accel_bias, start.gyro_bias);
    started_ = true;
    return;
  }
  filter_.predict(sensors.imu, dt);
  // [m]; what stands on the floor is higher than that
  constexpr double kSonarSigma = 0.05, kBaroSigma = 0.3, kTable = 0.3;
  if (sensors.sonar) {
    const double z = -*sensors.sonar * rotation_EB(filter_.attitude()).matrix(2, 2);
    if (std::abs(z - filter_.position().z()) < kTable) filter_.correct_altitude(z, kSonarSigma);
  }
  if (sensors.baro) filter_.correct_altitude(-*sensors.baro, kBaroSigma);
  if (!(sensors.image || sensors.seen) || !pilot.sighting().fix) return;
  const FixOnCourse& fix = *pilot.sighting().fix;
  Eigen::Vector3d sigma = fix.covariance.diagonal().cwiseSqrt(), p_EB = fix.p_EB;
  if (!fix.has_height) p_EB.z() = filter_.position().z(), sigma.z() = 10.0;
  filter_.correct_position(p_EB, sigma);
  if (fix.yaw) filter_.correct_heading(*fix.yaw, fix.yaw_sigma);
}

Estimate InertialFollower::estimate(const Pilot& pilot) const {
  Estimate e = pilot.estimate();
  if (!started_) return e;
  e.p_EB = filter_.position(), e.v_E = filter_.velocity(), e.attitude = filter_.attitude();
  e.accel_bias = filter_.accel_bias(), e.gyro_bias = filter_.gyro_bias();
  return e;
}

}  // namespace gatefly::flight_log
