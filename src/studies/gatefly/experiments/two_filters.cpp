// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/two_filters.hpp"

#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {

void DragPilot::step(const FilterTick& tick) {
  navigator.predict(tick.imu, tick.t);
  if (!tick.z) return;
  navigator.correct_height(-*tick.z, kAltitudeSigma);
  navigator.correct_heading(wrap_angle(tick.yaw - navigator.ahrs().attitude().yaw),
                            kHeadingSigma * kHeadingSigma);
}

void DragPilot::fix(const Eigen::Vector3d& p_EB, const Eigen::Vector3d& sigma) {
  Fix fix{.p_GB = p_EB};
  fix.covariance = sigma.cwiseAbs2().asDiagonal();
  (void)navigator.correct(fix, navigator.time());
}

void InertialPilot::step(const FilterTick& tick) {
  filter.predict(tick.imu, tick.dt);
  if (!tick.z) return;
  filter.correct_altitude(*tick.z, kAltitudeSigma);
  filter.correct_heading(tick.yaw, kHeadingSigma);
}

}  // namespace gatefly::experiments
