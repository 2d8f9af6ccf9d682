// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/paper/paper_guidance.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/control/arc.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {

PaperGuidance::PaperGuidance(const PaperControlParams& params, const GuidanceParams& ours,
                             double filter_drag_x, double imu_hz)
    : params_{params},
      lateral_{ours.lateral},
      altitude_params_{ours.altitude},
      gravity_{ours.gravity},
      speed_scale_{filter_drag_x / params.speed_drag},
      landing_{ours},
      speeds_(std::max<std::size_t>(1, static_cast<std::size_t>(params.speed_time * imu_hz)), 0.0) {
}

AttitudeCommand PaperGuidance::command(Phase& phase, const NavigationState& now,
                                       const Course& course) {
  if (std::holds_alternative<Land>(phase)) return landing_.command(phase, now, course);
  if (!is_flying(phase)) return {.yaw = now.attitude.yaw};
  measure_speed(now);
  AttitudeCommand c;
  if (auto* turning = std::get_if<Turn>(&phase))
    c = turn(turning->arc, now, course);
  else if (std::holds_alternative<TakeOff>(phase))
    c = {.pitch = params_.pitch, .yaw = course.track().start_heading};
  else
    c = straight(now, course);
  // The height is the altimeter's, arc or not; Eq. (27)'s thrust is the model's.
  const double up = altitude_.step(course.gate().p_EG.z(), 0.0, now.p_EB.z(), now.v_E.z(), now.dt,
                                   altitude_params_);
  c.thrust = thrust_for(gravity_ + up, now.R_EB.matrix(2, 2));
  return c;
}

// Eq. (22).
AttitudeCommand PaperGuidance::straight(const NavigationState& now, const Course& course) const {
  return {.roll = lateral_roll(now.p_GB.y(), now.v_GB.y(), lateral_),
          .pitch = params_.pitch,
          .yaw = course.gate().yaw_EG};
}

// Eq. (29), and nothing else: neither position nor speed are looked at.
AttitudeCommand PaperGuidance::turn(Arc& arc, const NavigationState& now,
                                    const Course& course) const {
  const Segment& planned = course.path().segments[1];
  AttitudeCommand c = step(arc, now.dt,
                           {.radius = 1.0 / planned.curvature,
                            .pitch = params_.pitch,
                            .drag = params_.arc_drag,
                            .gravity = gravity_});
  c.yaw_rate = 0.0;  // the attitude loop was given angles only
  return c;
}

// Mean over the last second, times what the two drag coefficients differ by.
void PaperGuidance::measure_speed(const NavigationState& now) {
  if (now.dt <= 0.0) return;
  double& oldest = speeds_[samples_ % speeds_.size()];
  const double count = static_cast<double>(speeds_.size());
  const double speed = speed_scale_ * now.v_B.x();
  mean_speed_ += (speed - oldest) / count;
  oldest = speed;
  ++samples_;
}

bool PaperGuidance::turn_ahead(const NavigationState& now, const Course& course) const {
  const double off = std::abs(wrap_angle(course.gate().yaw_EG - now.attitude.yaw));
  return course.before_approach() && off >= params_.arc_end;
}

}  // namespace gatefly
