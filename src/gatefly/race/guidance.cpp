// SPDX-License-Identifier: Apache-2.0
// The pilot's outer loop: which attitude each phase of the race asks for.
#include <algorithm>
#include <cmath>

#include "gatefly/control/arc.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly {
namespace {

constexpr double kMaxRoll = 38.0 * kDegree;  // turn and correction together

}  // namespace

AttitudeCommand Pilot::command(double dt) {
  if (auto* phase = std::get_if<TakeOff>(&phase_)) return command_for(*phase, dt);
  if (auto* phase = std::get_if<Straight>(&phase_)) return command_for(*phase, dt);
  if (auto* phase = std::get_if<Turn>(&phase_)) return command_for(*phase, dt);
  if (auto* phase = std::get_if<Search>(&phase_)) return command_for(*phase, dt);
  if (auto* phase = std::get_if<Land>(&phase_)) return command_for(*phase, dt);
  return {.yaw = ahrs_.attitude().yaw};
}

AttitudeCommand Pilot::command_for(const TakeOff&, double dt) {
  const double z = path().z_at(0.0);
  AttitudeCommand c = hold(config_.track.start, config_.track.start_heading, z, dt);
  // Near the floor the drone only goes up.
  if (-p_EB().z() < 0.25) c.roll = c.pitch = 0.0;
  return c;
}

// Li18 Eq. (22): roll by PD on the distance to the line, heading along it; the pitch holds the
// speed.
AttitudeCommand Pilot::command_for(const Straight&, double dt) {
  const PathPoint here = path().at(progress_);
  AttitudeCommand c;
  c.roll = cross_track_roll(progress_);
  c.pitch = pitch_for_speed(wanted_speed());
  c.yaw = here.heading;
  c.thrust = thrust_for(vertical_accel(path().z_at(progress_), 0.0, dt));
  return c;
}

// Li18 Eq. (29) gives roll and heading; the drag filter still knows where the arc is, so the same
// PD trims it.
AttitudeCommand Pilot::command_for(Turn& phase, double dt) {
  const double lead = config_.speed.roll_lead * std::max(0.0, forward_speed());
  const PathPoint soon = path().at(progress_ + lead);
  ArcParams arc;
  arc.radius = soon.curvature == 0.0 ? 0.0 : 1.0 / soon.curvature;
  arc.pitch = pitch_for_speed(wanted_speed());
  arc.drag = {config_.filter.model.drag.x(), config_.filter.model.drag.y(), 0.0};
  arc.gravity = config_.filter.model.gravity;
  AttitudeCommand c = gatefly::step(phase.arc, dt, arc);
  c.roll = std::clamp(c.roll + cross_track_roll(progress_), -kMaxRoll, kMaxRoll);
  c.yaw = path().at(progress_ + 0.5 * lead).heading;
  c.thrust = thrust_for(vertical_accel(path().z_at(progress_), 0.0, dt));
  return c;
}

AttitudeCommand Pilot::command_for(const Search& phase, double dt) {
  // Wait on the gate's axis and look to both sides of it.
  const Eigen::Vector3d wait =
      gate().p_EG + rotation_z(gate().yaw_EG) * Eigen::Vector3d{hold_x_, 0, 0};
  const double since = time_ - phase.since;
  const double sweep = 40.0 * kDegree * gatefly::sin(2 * kPi * since / 5.0);
  const double yaw = gate().yaw_EG + (situation().since_fix < 0.5 || since < 1.5 ? 0.0 : sweep);
  return hold(wait.head<2>(), yaw, gate().p_EG.z(), dt);
}

AttitudeCommand Pilot::command_for(const Land& phase, double dt) {
  // Brake for a second, then down at 0.5 m/s.
  constexpr double kSink = 0.5;
  const double sinking = std::max(0.0, time_ - phase.since - 1.0);
  AttitudeCommand c = hold(p_EB().head<2>(), ahrs_.attitude().yaw, phase.z, 0.0);
  c.thrust = thrust_for(vertical_accel(phase.z + kSink * sinking, sinking > 0.0 ? kSink : 0.0, dt));
  return c;
}

// Position hold: PD in the earth frame, turned into the body's heading.
AttitudeCommand Pilot::hold(const Eigen::Vector2d& p_E, double yaw, double z, double dt) {
  // [1/s²], [1/s], [1/s³]: ω 0.95, ζ 1
  constexpr double kStiffness = 0.9, kDamping = 2.0, kIntegral = 0.25;
  const Eigen::Vector3d v_E = ahrs_.R_EB() * velocity_.v_B();
  // Whoever comes fast brakes first: pulling to the side at once would fly an arc into a wall.
  const double slow = std::clamp(1.5 - v_E.head<2>().norm(), 0.0, 1.0);
  const Eigen::Vector2d off = slow * (p_E - p_EB().head<2>()).cwiseMax(-1.0).cwiseMin(1.0);
  // A degree of tilt error in the AHRS would hold the drone 0.2 m beside the place.
  hold_integral_ = (hold_integral_ + kIntegral * dt * off).cwiseMax(-0.5).cwiseMin(0.5);
  Eigen::Vector2d accel = kStiffness * off + hold_integral_ - kDamping * v_E.head<2>();
  // [m/s²]; braking from 1.7 m/s within 0.9 m, roll's lag included
  const double most = slow < 1.0 ? 3.5 : 1.8;
  const double norm = accel.norm();
  if (norm > most) accel *= most / norm;
  const auto [s, co] = sincos(ahrs_.attitude().yaw);
  const double forward = co * accel.x() + s * accel.y(), right = -s * accel.x() + co * accel.y();
  AttitudeCommand c;
  c.pitch = -atan(forward / config_.filter.model.gravity);
  c.roll = atan(right / config_.filter.model.gravity);
  c.yaw = yaw;
  c.thrust = thrust_for(vertical_accel(z, 0.0, dt));
  return c;
}

double Pilot::forward_speed() const { return velocity_.v_B().x(); }

// As fast as wanted, slower ahead of and in an arc.
double Pilot::wanted_speed() const {
  double speed = config_.plan.speed;
  const double x = filter().position().x();
  // A short way from the last turn to the gate leaves little time to come onto its axis.
  const Segment& last = path().segments.back();
  const Segment& turn =
      path().segments[path().segments.size() > 1 ? path().segments.size() - 2 : 0];
  if (path().length() - progress_ < last.length + turn.length)
    speed = std::min(speed, std::max(config_.speed.slowest, last.length / config_.speed.settle));
  const bool unsure = time_ - last_fix_ > 0.6 && filter().lateral_sigma() > 0.2;
  if (unsure && x > -config_.speed.unsure_before && x < 0.0)
    speed = std::min(speed, config_.speed.unsure);
  const double reach = config_.speed.brake_lead * std::clamp(forward_speed(), 0.5, 6.0);
  for (double ahead = 0.0; ahead <= reach; ahead += 0.2) {
    const double curvature = std::abs(path().at(progress_ + ahead).curvature);
    if (curvature > 0.0) speed = std::min(speed, std::sqrt(config_.plan.max_lateral / curvature));
  }
  return speed;
}

// θ_0 is the pitch that flies `speed` against drag; the rest brings the speed there.
double Pilot::pitch_for_speed(double speed) const {
  const double trim = atan(config_.filter.model.drag.x() * speed / config_.filter.model.gravity);
  return std::clamp(trim + config_.speed.pitch_gain * (forward_speed() - speed),
                    -config_.speed.max_pitch, -config_.speed.min_pitch);
}

double Pilot::vertical_accel(double z_target, double vz_target, double dt) {
  const double v_z = (ahrs_.R_EB() * velocity_.v_B()).z();
  return altitude_.step(z_target, vz_target, p_EB().z(), v_z, dt, config_.altitude);
}

double Pilot::thrust_for(double accel_up) const {
  return (config_.filter.model.gravity + accel_up) / std::max(0.6, ahrs_.R_EB().matrix(2, 2));
}

double Pilot::cross_track_roll(double s) const {
  const PathPoint here = path().at(s);
  const auto [sine, cosine] = sincos(here.heading);
  const Eigen::Vector2d right{-sine, cosine};
  const Eigen::Vector3d v_E = ahrs_.R_EB() * velocity_.v_B();
  return lateral_roll(right.dot(p_EB().head<2>() - here.position), right.dot(v_E.head<2>()),
                      config_.lateral);
}

}  // namespace gatefly
