// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/seen_fix.hpp"

#include <cmath>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {

RotationGB R_GB_of(const Navigator::Past& then) {
  return {rotation_EB(Attitude{then.input.roll, then.input.pitch, then.input.yaw}).matrix};
}

bool fuse(const SeenFix& seen, const MapGate& gate, double gate_yaw_sigma, Navigator& navigator,
          Sighting& sighting) {
  const Fix fix = navigator.as_fused(seen.fix);
  const double nis = seen.then->filter.nis(fix);
  const Eigen::Vector3d moved = navigator.filter().position() - seen.then->filter.position();
  sighting.offered = true;
  const Fusion fusion = navigator.correct(fix, seen.then->time, seen.may_restart);
  if (fusion != Fusion::kAccepted && fusion != Fusion::kRestarted) return false;
  const Eigen::Matrix3d R_EG = rotation_z(gate.yaw_EG);
  FixOnCourse& used = sighting.fix.emplace();
  used.p_EB = gate.p_EG + R_EG * (fix.p_GB + moved);
  used.covariance = R_EG * fix.covariance * R_EG.transpose();
  used.has_height = fix.has_height;
  if (fix.yaw_error) used.yaw = wrap_angle(navigator.ahrs().attitude().yaw + *fix.yaw_error);
  used.yaw_sigma = std::sqrt(fix.yaw_variance + gate_yaw_sigma * gate_yaw_sigma);
  if (fusion == Fusion::kAccepted) sighting.nis = nis, sighting.nis_dof = fix.has_height ? 3 : 2;
  sighting.source = seen.source;
  sighting.tells_height = fix.has_height;
  return true;
}

}  // namespace gatefly
