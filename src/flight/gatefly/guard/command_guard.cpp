// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/command_guard.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly::guard {
namespace {

constexpr double kMostClimb = 3.0;  ///< A speed beyond it is not believed [m/s].
constexpr double kLongest = 0.1;    ///< Longest period between two commands [s].

/// Part of the thrust that lifts.
double upright(const AttitudeCommand& command) { return cos(command.roll) * cos(command.pitch); }

bool finite(const AttitudeCommand& c) {
  return std::isfinite(c.roll) && std::isfinite(c.pitch) && std::isfinite(c.yaw) &&
         std::isfinite(c.yaw_rate) && std::isfinite(c.thrust);
}

/// A heading of many turns is nonsense, too.
bool sensible(const Belief& belief) {
  return std::abs(belief.yaw) < 100.0 && belief.v_E.allFinite() && belief.climb_sigma >= 0.0;
}

/// A period that is no number or not positive counts as a long one.
double period(double dt) { return dt >= 0.0 && dt < kLongest ? dt : kLongest; }

}  // namespace

bool CommandGuard::height_known(const Belief& belief) const {
  return belief.height_age <= limits_.height_trust;
}

/// Lift that does not climb, as far as that can be told without a height.
double CommandGuard::most_lift(const Belief& belief) const {
  constexpr double kFades = 0.3;  // of the way to may_rise [m]
  const double by_thrust = hover_ - limits_.climb_damping * up_;
  const double falls = belief.v_E.z() - belief.climb_sigma;
  const double by_filter =
      hover_ + std::min(limits_.fall_damping * falls, limits_.stops_fall_by * hover_);
  const double rises_to =
      risen_ + std::max(0.0, up_) / limits_.climb_damping;  // till it has stopped
  const double left = std::clamp((limits_.may_rise - rises_to) / kFades, 0.0, 1.0);
  return std::max(0.0, by_thrust + left * std::max(0.0, by_filter - by_thrust));
}

AttitudeCommand CommandGuard::limited(const AttitudeCommand& command, const Belief& belief) const {
  AttitudeCommand c = command;
  c.roll = std::clamp(c.roll, -limits_.tilt, limits_.tilt);
  c.pitch = std::clamp(c.pitch, -limits_.tilt, limits_.tilt);
  c.thrust = std::clamp(c.thrust, 0.0, limits_.thrust);
  if (!height_known(belief)) c.thrust = std::min(c.thrust, most_lift(belief) / upright(c));
  return c;
}

/// Lift that makes the strongest rotors sink as wanted: of the others it is less than the weight.
double CommandGuard::ending_lift() const {
  const double hover = std::min(hover_, kGravity);
  const double wanted = hover - limits_.climb_damping * (up_at_most_ + limits_.sink);
  return std::clamp(wanted, 0.7 * hover, 1.2 * hover) / (1.0 + limits_.hover_doubt);
}

AttitudeCommand CommandGuard::descent(const Belief& belief) const {
  const double since = std::max(0.0, ending_for_ - limits_.fades_after);
  const double left = std::max(0.2, 1.0 - limits_.fade * since * since);
  const double part = belief.stands ? std::min(left, limits_.set_down) : left;
  return {.yaw = belief.yaw, .thrust = part * ending_lift()};
}

void CommandGuard::follow_ending(bool ending, const Belief& belief, double lift, double dt) {
  if (!ending) {
    const double climb = std::clamp(-belief.v_E.z(), -kMostClimb, kMostClimb);
    up_at_most_ = height_known(belief) ? up_ : std::max({up_, climb, 0.0});
    ending_for_ = 0.0;
    return;
  }
  // By the lift before it fades: the climb that fading costs must not be made up for.
  up_at_most_ += ((1.0 + limits_.hover_doubt) * lift - std::min(hover_, kGravity)) * dt;
  up_at_most_ = std::clamp(up_at_most_, -kMostClimb, kMostClimb);
  ending_for_ += dt;
}

/// Compares the last command's lift with the climb that it brought.
void CommandGuard::learn_hover(const Belief& belief, double dt) {
  const double climb = std::clamp(-belief.v_E.z(), -kMostClimb, kMostClimb);
  if (learns_ && belief.height_age <= limits_.learns_from) {
    const double shown = std::clamp(lift_ - (climb - climb_) / dt, 0.0, limits_.thrust);
    hover_ += std::min(1.0, dt / limits_.hover_time) * (shown - hover_);
    hover_ = std::clamp(hover_, limits_.least_hover * kGravity, limits_.most_hover * kGravity);
  }
  climb_ = climb;
}

AttitudeCommand CommandGuard::braking(const Belief& belief) const {
  const auto [sin_yaw, cos_yaw] = sincos(belief.yaw);
  const double forward = cos_yaw * belief.v_E.x() + sin_yaw * belief.v_E.y();
  const double right = -sin_yaw * belief.v_E.x() + cos_yaw * belief.v_E.y();
  const auto against = [&](double speed) {
    return std::clamp(-speed / limits_.brake_time, -limits_.brake_accel, limits_.brake_accel);
  };
  AttitudeCommand c = descent(belief);
  c.pitch = -atan(against(forward) / kGravity);  // nose up pushes back
  c.roll = atan(against(right) / kGravity);
  c.thrust /= upright(c);
  return c;
}

AttitudeCommand CommandGuard::step(Action action, const AttitudeCommand& pilot,
                                   const Belief& belief_now, double dt) {
  const Belief belief = sensible(belief_now) ? belief_now : Belief{.height_age = Situation::kNever};
  // In between the estimate drifts, and is not asked.
  const bool told_anew = belief.height_age <= height_age_ && height_known(belief);
  if (told_anew) up_ = std::clamp(-belief.v_E.z(), -kMostClimb, kMostClimb), risen_ = 0.0;
  height_age_ = belief.height_age;
  learn_hover(belief, period(dt));
  AttitudeCommand sent{.yaw = belief.yaw};
  if (action == Action::kPilot)
    sent = limited(finite(pilot) ? pilot : descent(belief), belief);
  else if (action == Action::kBrake)
    sent = limited(braking(belief), belief);
  else if (action == Action::kDescend)
    sent = limited(descent(belief), belief);
  else
    return learns_ = false, sent;
  follow_ending(action != Action::kPilot, belief, ending_lift(), period(dt));
  const double lift = sent.thrust * upright(sent);
  lift_ = lift, learns_ = action == Action::kPilot;
  up_ = std::clamp(up_ + (lift - hover_) * period(dt), -kMostClimb, kMostClimb);
  risen_ += up_ * period(dt);
  return sent;
}

}  // namespace gatefly::guard
