// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/two_filters.hpp"

namespace gatefly::experiments {

void DragPilot::step(const FilterTick& tick) {
  const Attitude before = ahrs.attitude();
  drag_model::Input input{before.roll, before.pitch, tick.yaw, tick.accel_B, ahrs.rate_B()};
  ahrs.update(tick.imu, drag_model::velocity_B(filter.state(), input, filter.params().model),
              tick.dt);
  const Attitude now = ahrs.attitude();
  input.roll = now.roll, input.pitch = now.pitch, input.gyro_B = ahrs.rate_B();
  filter.predict(input, tick.dt);
  if (tick.z) (void)filter.correct_altitude(*tick.z, kAltitudeSigma);
}

void DragPilot::fix(const Eigen::Vector3d& p_EB, const Eigen::Vector3d& sigma) {
  Fix fix{.p_GB = p_EB};
  fix.covariance = sigma.cwiseAbs2().asDiagonal();
  (void)filter.correct(fix);
}

void InertialPilot::step(const FilterTick& tick) {
  filter.predict(tick.imu, tick.dt);
  if (!tick.z) return;
  filter.correct_altitude(*tick.z, kAltitudeSigma);
  filter.correct_heading(tick.yaw, kHeadingSigma);
}

}  // namespace gatefly::experiments
