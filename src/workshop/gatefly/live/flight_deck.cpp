// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/flight_deck.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/rotation_vector.hpp"
#include "gatefly/geometry/seconds.hpp"

namespace gatefly::live {
namespace {

using std::chrono::nanoseconds;

constexpr double kGain =
    4.0;  ///< Gain of rates on the attitude [1/s]. Ours: a fifth of 1 / 50 ms of delay.
constexpr double kMostRate = 2.0;  ///< [rad/s]

bool is_ending(guard::Action action) {
  return action == guard::Action::kBrake || action == guard::Action::kDescend;
}

}  // namespace

bool Fence::holds(const Eigen::Vector3d& p_EB) const {
  const auto p = p_EB.head<2>().array();
  return (p >= low.array()).all() && (p <= high.array()).all() && -p_EB.z() <= height;
}

Fence fence_around(const Track& track, const RacePlan& plan, double aside, double above) {
  Fence fence{.low = track.start.head<2>(), .high = track.start.head<2>()};
  for (const MapGate& gate : track.gates) {
    fence.low = fence.low.cwiseMin(gate.p_EG.head<2>());
    fence.high = fence.high.cwiseMax(gate.p_EG.head<2>());
    fence.height = std::max(fence.height, above - gate.p_EG.z());
  }
  fence.low.array() -= aside, fence.high.array() += aside;
  const auto include = [&](const Path& path) {
    constexpr double kStep = 0.1;  // [m]
    for (double s = 0.0; s < path.length(); s += kStep) {
      const Eigen::Vector2d p = path.at(s).position;
      fence.low = fence.low.cwiseMin((p.array() - 0.5 * aside).matrix());
      fence.high = fence.high.cwiseMax((p.array() + 0.5 * aside).matrix());
      fence.height = std::max(fence.height, 0.5 * above - path.z_at(s));
    }
  };
  include(plan.start);
  for (const Path& leg : plan.legs) include(leg);
  if (track.ceiling > 0.0) fence.height = std::min(fence.height, track.ceiling);
  return fence;
}

double left_after_braking(const guard::CommandLimits& limits) {
  return std::max(0.0, 1.0 - seconds(kStickPeriod) / limits.brake_time);
}

Eigen::Vector3d rates_towards(const AttitudeCommand& command, double roll, double pitch) {
  // The heading is left alone: a controller's compass is not the map's.
  const Eigen::Matrix3d is = rotation_EB(Attitude{roll, pitch, 0.0}).matrix;
  const Eigen::Matrix3d wanted = rotation_EB(Attitude{command.roll, command.pitch, 0.0}).matrix;
  const Eigen::Vector3d most = Eigen::Vector3d::Constant(kMostRate);
  return (kGain * turn_of(is.transpose() * wanted)).cwiseMax(-most).cwiseMin(most);
}

guard::Situation FlightDeck::situation(const ControllerState& controller, const Wanted& wanted,
                                       bool told_to_end, nanoseconds now) const {
  const Eigen::Vector3d up_E =
      rotation_EB(Attitude{controller.attitude.roll, controller.attitude.pitch, 0}).matrix.col(2);
  return {.time = now,
          .hand_over_tested = params_.hand_over_tested,
          .course_can_be_flown = true,  // else there would be no pilot
          .armed = controller.armed,
          .override_on = controller.override_on,
          .other_client = controller.other_client,
          .acknowledged = controller.acknowledged,
          .status_age = now - controller.status_at,
          .attitude_age = now - std::min(controller.attitude_at, controller.imu_changed_at),
          .picture_age = now - wanted.picture_at,
          .command_age = now - wanted.at,
          .height_age = now - wanted.height_at,
          .tilt = std::acos(std::clamp(up_E.z(), -1.0, 1.0)),
          .inside_fence = params_.fence.holds(wanted.p_EB),
          .battery_v = controller.battery_v,
          .told_to_end = told_to_end || wanted.landed};
}

FlightDeck::Sent FlightDeck::step(const ControllerState& controller, const Wanted& wanted,
                                  bool told_to_end, nanoseconds now) {
  guard::HandOverParams params = params_.hand_over;
  params.picture = wanted.picture_limit;
  const guard::Situation situation = this->situation(controller, wanted, told_to_end, now);
  state_ = guard::next(state_, situation, params);
  guard::Action action = guard::action_of(state_, situation, params);
  // On the pad the pilot asks for nothing.
  const bool rests = action == guard::Action::kPilot && !wanted.steers;
  // A pilot that is late does not tell what braking has done.
  v_E_ = wanted.at == wanted_at_ ? Eigen::Vector3d{left_after_braking(params_.limits) * v_E_}
                                 : wanted.v_E;
  wanted_at_ = wanted.at;
  const guard::Belief belief{.yaw = wanted.yaw,
                             .v_E = v_E_,
                             .climb_sigma = wanted.climb_sigma,
                             .height_age = situation.height_age,
                             .stands = wanted.landed};
  const AttitudeCommand command =
      guard_.step(rests ? guard::Action::kNeutral : action, wanted.command.attitude, belief,
                  seconds(kStickPeriod));
  ending_ = {.guard = guard_,
             .yaw = wanted.yaw,
             .v_x = v_E_.x(),
             .v_y = v_E_.y(),
             .v_z = v_E_.z(),
             .roll = controller.attitude.roll,
             .pitch = controller.attitude.pitch,
             .ending_for = is_ending(action) ? seconds(now - state_.since) : 0.0,
             .stands = wanted.landed,
             .in_air = !rests && (action == guard::Action::kPilot || is_ending(action))};
  if (action < guard::Action::kPilot || rests) return {action, {}};
  const AttitudeCommand& pilot = wanted.command.attitude;
  const bool as_wanted =
      action == guard::Action::kPilot && command.roll == pilot.roll && command.pitch == pilot.pitch;
  Eigen::Vector3d rates_B = as_wanted ? wanted.command.rates_B : Eigen::Vector3d::Zero().eval();
  if (!as_wanted && situation.attitude_age <= params.attitude)
    rates_B = rates_towards(command, controller.attitude.roll, controller.attitude.pitch);
  return {action, {.rests = false, .rates_B = rates_B, .thrust = command.thrust}};
}

}  // namespace gatefly::live
