// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/guidance.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/control/arc.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

// e^-x for x >= 0, 0.1 % off at x = 3: the reciprocal of a series of a sixteenth, squared four times.
double decayed(double x) {
  const double h = x / 16.0;
  double y = 1.0 / (1.0 + h + 0.5 * h * h + h * h * h / 6.0);
  for (int i = 0; i < 4; ++i) y *= y;
  return y;
}

// The wind as far as it is known: shrunk towards none by what of it may be the estimate's error
// (James and Stein 1961).
Eigen::Vector2d sure_wind(const NavigationState& now) {
  const double square = now.wind_E.squaredNorm();
  if (!(square > now.wind_variance)) return Eigen::Vector2d::Zero();
  return (1.0 - now.wind_variance / square) * now.wind_E;
}

}  // namespace

AttitudeCommand Guidance::command(Phase& phase, const NavigationState& now, const Course& course) {
  const bool entered = phase.index() != last_phase_;
  last_phase_ = phase.index();
  if (entered) hold_integral_.setZero();
  const bool on_way =
      std::holds_alternative<Straight>(phase) || std::holds_alternative<Turn>(phase);
  if (!on_way) aside_ = turned_ = 0.0;
  if (std::holds_alternative<TakeOff>(phase)) return take_off(now, course);
  if (std::holds_alternative<Straight>(phase)) {
    if (const Stop* stop = near_stop(course)) return stand(*stop, now, course);
    return look_aside(straight(now, course), now, course);
  }
  if (auto* turning = std::get_if<Turn>(&phase))
    return look_aside(turn(turning->arc, now, course), now, course);
  if (const auto* searching = std::get_if<Search>(&phase)) return search(*searching, now, course);
  if (const auto* landing = std::get_if<Land>(&phase)) return land(*landing, now);
  return {.yaw = now.attitude.yaw};
}

AttitudeCommand Guidance::take_off(const NavigationState& now, const Course& course) {
  const Track& track = course.track();
  AttitudeCommand c = hold(track.start, track.start_heading, now.dt, now);
  c.thrust = thrust(course.path().z_at(0.0), 0.0, now);
  if (-now.p_EB.z() < params_.hold.climb_until) c.roll = c.pitch = 0.0;
  return c;
}

// Eq. (22): roll by PD on the distance to the line, heading along it; the pitch holds the speed.
AttitudeCommand Guidance::straight(const NavigationState& now, const Course& course) {
  const double s = course.progress();
  const PathPoint here = course.path().at(s);
  AttitudeCommand c;
  c.roll = cross_track_roll(here, now);
  c.pitch = pitch_for_speed(wanted_speed(now, course), now);
  c.yaw = here.heading;
  c.thrust = thrust_on_path(now, course);
  return c;
}

// Eq. (29) gives roll and heading; the drag filter still knows where the arc is, so the same PD trims
// it.
AttitudeCommand Guidance::turn(Arc& arc, const NavigationState& now, const Course& course) {
  const Path& path = course.path();
  const double s = course.progress();
  const double lead = params_.speed.roll_lead * std::max(0.0, entry_speed(now));
  const PathPoint soon = path.at(course.ahead(lead));
  ArcParams params;
  params.radius = soon.curvature == 0.0 ? 0.0 : 1.0 / soon.curvature;
  params.pitch = pitch_for_speed(wanted_speed(now, course), now);
  params.drag = {params_.drag.x(), params_.drag.y(), 0.0};
  params.gravity = params_.gravity;
  AttitudeCommand c = step(arc, now.dt, params);
  c.roll = std::clamp(c.roll + cross_track_roll(path.at(s), now), -params_.speed.max_roll,
                      params_.speed.max_roll);
  c.yaw = path.at(course.ahead(0.5 * lead)).heading;
  c.thrust = thrust_on_path(now, course);
  return c;
}

// Turns the tilt from the axes of the way into those of the commanded heading. The inner loop tilts
// first, so that the drone flies along the way while the nose still turns.
AttitudeCommand Guidance::look_aside(const AttitudeCommand& along, const NavigationState& now,
                                     const Course& course) {
  const LookAsideParams& p = params_.look_aside;
  if (p.most <= 0.0) return along;
  const double most = p.rate * now.dt;
  const double off = wrap_angle(wanted_aside(along.yaw, now, course) - aside_);
  aside_ = wrap_angle(aside_ + std::clamp(off, -most, most));
  turned_ = wrap_angle(now.attitude.yaw - along.yaw);
  const auto [sine, cosine] = sincos(aside_);
  AttitudeCommand c = along;
  c.pitch = cosine * along.pitch - sine * along.roll;
  c.roll = cosine * along.roll + sine * along.pitch;
  c.yaw = wrap_angle(along.yaw + aside_);
  return c;
}

// Towards the gate, unless the gate itself asks for the nose.
double Guidance::wanted_aside(double heading, const NavigationState& now,
                              const Course& course) const {
  const LookAsideParams& p = params_.look_aside;
  const MapGate& gate = course.gate();
  const Eigen::Vector3d there = gate.p_EG - now.p_EB;
  if (course.finished() || there.norm() < p.until_sides * gate.side) return 0.0;
  return std::clamp(wrap_angle(atan2(there.y(), there.x()) - heading), -p.most, p.most);
}

const Stop* Guidance::near_stop(const Course& course) const {
  const Stop* stop = course.stop();
  const bool near = stop != nullptr && stop->s - course.progress() < params_.speed.stand_from;
  return near ? stop : nullptr;
}

// At a stop, for which a turn has no room: holds the place, turns, changes the height.
AttitudeCommand Guidance::stand(const Stop& stop, const NavigationState& now,
                                const Course& course) {
  aside_ = turned_ = 0.0;  // the nose turns to where the way goes on
  AttitudeCommand c = hold(course.path().at(stop.s).position, stop.heading, 0.0, now);
  c.thrust = thrust(stop.z, 0.0, now);
  return c;
}

// Waits on the gate's axis and looks to both sides of it, or stands and turns round.
AttitudeCommand Guidance::search(const Search& phase, const NavigationState& now,
                                 const Course& course) {
  const MapGate& gate = course.gate();
  const double since = now.time - phase.since;
  const SweepParams& p = params_.sweep;
  if (phase.stand_at) {
    AttitudeCommand c =
        hold(*phase.stand_at, wrap_angle(phase.yaw + phase.rate * since), now.dt, now);
    c.thrust = thrust(course.path().z_at(course.progress()), 0.0, now);
    return c;
  }
  const Eigen::Vector3d wait =
      gate.p_EG + rotation_z(gate.yaw_EG) * Eigen::Vector3d{phase.gate_x, 0, 0};
  const bool ahead = now.since_fix < p.hold_after_fix || since < p.first_ahead;
  const double sweep = p.angle * gatefly::sin(2 * kPi * since / p.period);
  AttitudeCommand c = hold(wait.head<2>(), gate.yaw_EG + (ahead ? 0.0 : sweep), now.dt, now);
  c.thrust = thrust(gate.p_EG.z(), 0.0, now);
  return c;
}

AttitudeCommand Guidance::land(const Land& phase, const NavigationState& now) {
  const LandingParams& p = params_.landing;
  const double brake = phase.in_a_hurry ? 0.0 : p.brake;
  const double sinking = std::max(0.0, now.time - phase.since - brake);
  const double sink = phase.in_a_hurry ? p.hurry : p.sink;
  AttitudeCommand c = hold(now.p_EB.head<2>(), now.attitude.yaw, 0.0, now);
  c.thrust = thrust(phase.z + sink * sinking, sinking > 0.0 ? sink : 0.0, now);
  return c;
}

// PD in the earth frame, turned into the commanded heading.
AttitudeCommand Guidance::hold(const Eigen::Vector2d& p_E, double yaw, double dt,
                               const NavigationState& now) {
  const HoldParams& p = params_.hold;
  const Eigen::Vector2d v_E = now.v_E.head<2>();
  // Above this speed brake before steering: pulling to the side at once would fly an arc into a
  // wall.
  const double slow = std::clamp(p.brake_from - v_E.norm(), 0.0, 1.0);
  const Eigen::Vector2d off =
      slow * (p_E - now.p_EB.head<2>()).cwiseMax(-p.max_distance).cwiseMin(p.max_distance);
  hold_integral_ =
      (hold_integral_ + p.integral * dt * off).cwiseMax(-p.max_integral).cwiseMin(p.max_integral);
  Eigen::Vector2d accel = p.stiffness * off + hold_integral_ - p.damping * v_E;
  const double most = slow < 1.0 ? p.max_braking : p.max_accel;
  const double norm = accel.norm();
  if (norm > most) accel *= most / norm;
  accel += params_.drag.x() * sure_wind(now);  // leans against it
  const auto [sine, cosine] = sincos(yaw);
  const double forward = cosine * accel.x() + sine * accel.y();
  const double right = -sine * accel.x() + cosine * accel.y();
  AttitudeCommand c;
  c.pitch = -atan(forward / params_.gravity);
  c.roll = atan(right / params_.gravity);
  c.yaw = yaw;
  return c;
}

// As fast as wanted, slower ahead of and in an arc.
double Guidance::wanted_speed(const NavigationState& now, const Course& course) const {
  const SpeedParams& p = params_.speed;
  const Path& path = course.path();
  double speed = params_.cruise;
  // A short way from the last turn to the gate leaves little time to come onto its axis.
  const std::size_t segments = path.segments.size();
  const Segment& last = path.segments.back();
  const Segment& turn = path.segments[segments > 1 ? segments - 2 : 0];
  if (course.to_go() < last.length + turn.length) {
    constexpr double kStep = 0.1;  // [m/s]
    // At most as often as the speed wanted has tenths of a metre per second.
    while (speed > p.slowest && way_to_settle(path, speed, params_.max_lateral) < p.settle * speed)
      speed = std::max(p.slowest, speed - kStep);
  }
  const double slope = std::abs(path.height_at(course.progress()).slope);
  if (slope * speed > p.max_climb) speed = p.max_climb / slope;
  if (const Stop* stop = course.stop())
    speed = std::min(
        speed, std::sqrt(2.0 * p.braking.to_a_stop * std::max(0.0, stop->s - course.progress())));
  const double x = now.p_GB.x();
  const bool unsure = now.since_fix > p.unsure_after && now.lateral_sigma > p.unsure_sigma;
  if (unsure && x > -p.unsure_before && x < 0.0) speed = std::min(speed, p.unsure);
  const double reach = p.brake_lead * std::max(0.5, entry_speed(now));
  const auto slowed_to = [&](double limit, double way) {
    speed =
        std::min(speed, std::sqrt(limit * limit + 2.0 * p.braking.on_the_way * std::max(0.0, way)));
  };
  const double end = course.stop() != nullptr ? course.stop()->s : path.length();
  double s = 0.0;
  for (const Segment& segment : path.segments) {
    const double from = s - course.progress();
    s += segment.length;
    const double curvature = std::abs(segment.curvature);
    if (curvature == 0.0 || s < course.progress() || s - segment.length >= end) continue;
    slowed_to(std::min(std::sqrt(params_.max_lateral / curvature),
                       p.turn_in_lead / (p.roll_lead * curvature)),
              from - reach);
  }
  slowed_to(course.gate_speed(), course.to_go());
  return speed;
}

// θ_0 is the pitch that flies `speed` over the ground against drag, wind from behind taken off; the
// rest brings the speed there.
double Guidance::pitch_for_speed(double speed, const NavigationState& now) const {
  const SpeedParams& p = params_.speed;
  const auto [sine, cosine] = sincos(now.attitude.yaw - turned_);
  const double air = speed - Eigen::Vector2d{cosine, sine}.dot(sure_wind(now));
  const double trim = atan(params_.drag.x() * air / params_.gravity);
  constexpr double kSpare = 0.12;  // beyond the trim, to speed up by [rad]
  return std::clamp(trim + p.pitch_gain * (entry_speed(now) - speed),
                    std::min(-p.max_pitch, trim - kSpare), -p.min_pitch);
}

double Guidance::cross_track_roll(const PathPoint& here, const NavigationState& now) const {
  const auto [sine, cosine] = sincos(here.heading);
  const Eigen::Vector2d right{-sine, cosine};
  const double lean = params_.drag.y() * right.dot(sure_wind(now)) / params_.gravity;
  return lean + lateral_roll(right.dot(now.p_EB.head<2>() - here.position),
                             right.dot(now.v_E.head<2>()), params_.lateral);
}

// Specific thrust that holds the height z at the rate vz, both down.
double Guidance::thrust(double z, double vz, const NavigationState& now) {
  const double up = altitude_.step(z, vz, now.p_EB.z(), now.v_E.z(), now.dt, params_.altitude);
  return thrust_for(params_.gravity + up, now.R_EB.matrix(2, 2)) / (1.0 + now.thrust_found);
}

// On a ramp the height changes as fast as the way goes on; the rate is fed forward, so that it does
// not lag behind.
double Guidance::thrust_on_path(const NavigationState& now, const Course& course) {
  const PathHeight height = course.path().height_at(course.progress());
  const auto [sine, cosine] = sincos(course.path().at(course.progress()).heading);
  const double along = std::max(0.0, Eigen::Vector2d{cosine, sine}.dot(now.v_E.head<2>()));
  return thrust(height.z, height.slope * along, now);
}

// A critically damped decay that starts after the roll's lag.
double Guidance::lateral_at_gate(const NavigationState& now, const Course& course) const {
  constexpr double kSlowest = 0.5;  // [m/s]
  const double speed = std::max(kSlowest, entry_speed(now));
  double way = -now.p_GB.x(), off = now.p_GB.y(), rate = now.v_GB.y();
  if (course.to_go() > course.path().segments.back().length) {
    const PathPoint here = course.path().at(course.progress());
    const auto [sine, cosine] = sincos(here.heading);
    const Eigen::Vector2d right{-sine, cosine};
    way = course.to_go();
    off = right.dot(now.p_EB.head<2>() - here.position), rate = right.dot(now.v_E.head<2>());
  }
  const double t = std::max(0.0, way / speed - 1.5 * params_.speed.roll_lead);
  const double wt = std::sqrt(params_.lateral.kp * params_.gravity) * t;
  const double decay = decayed(wt);
  return (1.0 + wt) * decay * off + t * decay * rate;
}

// Along the way: the nose may have left it.
double Guidance::entry_speed(const NavigationState& now) const {
  const auto [sine, cosine] = sincos(turned_);
  return cosine * now.v_B.x() - sine * now.v_B.y();
}

bool Guidance::turn_ahead(const NavigationState& now, const Course& course) const {
  const double lead = params_.speed.roll_lead * std::max(0.0, entry_speed(now));
  return course.path().at(course.ahead(lead)).curvature != 0.0;
}

}  // namespace gatefly
