// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/hand_over.hpp"

#include <cmath>

namespace gatefly::guard {
namespace {

/// Why it must not even begin; nothing has been sent yet.
Reason why_not_begin(const Situation& now) {
  if (!now.hand_over_tested) return Reason::kNotTested;
  if (!now.course_can_be_flown) return Reason::kCourse;
  if (now.armed) return Reason::kArmedAtStart;
  if (now.override_on) return Reason::kOverrideAtStart;
  if (now.other_client) return Reason::kOtherClient;
  return now.told_to_end ? Reason::kTold : Reason::kNone;
}

/// Names a fault of sensors, pilot or program, whoever flies.
Reason fault(const Situation& now, const HandOverParams& params) {
  if (now.told_to_end) return Reason::kTold;
  if (now.other_client) return Reason::kOtherClient;
  if (now.attitude_age > params.attitude) return Reason::kAttitudeStale;
  if (now.status_age > params.status) return Reason::kStatusStale;
  if (now.command_age > params.command) return Reason::kPilotLate;
  if (now.picture_age > params.picture) return Reason::kPicturesStale;
  if (!(std::abs(now.tilt) <= params.tilt)) return Reason::kTilt;
  if (!now.inside_fence) return Reason::kFence;
  const bool battery_known = now.battery_v > 0.0;
  if (battery_known && now.battery_v < params.least_battery_v) return Reason::kBattery;
  return Reason::kNone;
}

Reason fault_in_flight(const HandOver& state, const Situation& now, const HandOverParams& params) {
  if (const Reason reason = fault(now, params); reason != Reason::kNone) return reason;
  // On the floor nothing has told a height yet: counted from the beginning of the flight.
  const auto flown = now.time - state.since;
  if (now.height_age > params.height && flown > params.height) return Reason::kHeightLost;
  return flown > params.flight ? Reason::kTime : Reason::kNone;
}

HandOver entered(Phase phase, Reason reason, const HandOver& before, const Situation& now) {
  return {.phase = phase,
          .reason = reason,
          .since = now.time,
          .override_was = now.override_on,
          .flown = before.flown || phase == Phase::kFlying};
}

HandOver started(HandOver state, const Situation& now, const HandOverParams& params) {
  if (now.status_age > params.status) {
    state.reason = Reason::kStatusStale;
    return state;
  }
  const Reason reason = why_not_begin(now);
  return entered(reason == Reason::kNone ? Phase::kStreaming : Phase::kOver, reason, state, now);
}

HandOver streamed(HandOver state, const Situation& now, const HandOverParams& params) {
  if (now.told_to_end) return entered(Phase::kOver, Reason::kTold, state, now);
  if (now.other_client) return entered(Phase::kOver, Reason::kOtherClient, state, now);
  const bool comes_on = now.override_on && !state.override_was;
  if (!now.override_on) state.blocked = false, state.reason = Reason::kNone;
  if (comes_on) {
    state.reason = fault(now, params);
    if (!now.armed) state.reason = Reason::kSwitchOrder;
    if (now.acknowledged < params.neutral_frames) state.reason = Reason::kTooEarly;
    state.blocked = state.reason != Reason::kNone;
    if (!state.blocked) return entered(Phase::kFlying, Reason::kNone, state, now);
  }
  state.override_was = now.override_on;
  return state;
}

bool taken_back(const Situation& now) { return !now.armed || !now.override_on; }

}  // namespace

std::string_view text_of(Reason reason) {
  switch (reason) {
    case Reason::kNone:
      return "";
    case Reason::kNotTested:
      return "the hand-over test of this drone and this program is missing or out of date";
    case Reason::kCourse:
      return "the course cannot be flown";
    case Reason::kArmedAtStart:
      return "the drone is armed: disarm it before the program starts";
    case Reason::kOverrideAtStart:
      return "the override is on: switch it off before the program starts";
    case Reason::kOtherClient:
      return "another program talks to the controller";
    case Reason::kTooEarly:
      return "the override came on before the controller had neutral sticks: switch it off, wait, "
             "and on again";
    case Reason::kSwitchOrder:
      return "the override came on before arming: switch it off, arm, then on again";
    case Reason::kStatusStale:
      return "the controller does not say whether it is armed";
    case Reason::kAttitudeStale:
      return "no attitude from the controller";
    case Reason::kPicturesStale:
      return "no pictures from the camera";
    case Reason::kPilotLate:
      return "the pilot is late";
    case Reason::kHeightLost:
      return "no gate has told the height for too long";
    case Reason::kTilt:
      return "tilted too far";
    case Reason::kFence:
      return "outside of the fence";
    case Reason::kBattery:
      return "the battery is low";
    case Reason::kTime:
      return "the time is over";
    case Reason::kTold:
      return "told to end";
  }
  return "";
}

HandOver next(const HandOver& state, const Situation& now, const HandOverParams& params) {
  HandOver before = state;
  if (!now.armed && now.status_age <= params.status) before.flown = false;
  switch (before.phase) {
    case Phase::kStarting:
      return started(before, now, params);
    case Phase::kStreaming:
      return streamed(before, now, params);
    case Phase::kFlying:
      if (taken_back(now)) return entered(Phase::kStreaming, Reason::kNone, before, now);
      if (const Reason reason = fault_in_flight(before, now, params); reason != Reason::kNone)
        return entered(Phase::kEnding, reason, before, now);
      return before;
    case Phase::kEnding:
      // An old status does not tell where the pilot's switch is now.
      if (taken_back(now) && now.status_age <= params.status)
        return entered(Phase::kOver, before.reason, before, now);
      if (now.status_age > params.gone || now.time - before.since > params.ending)
        return entered(Phase::kOver, before.reason, before, now);
      return before;
    case Phase::kOver:
      return before;
  }
  return before;
}

Action action_of(const HandOver& state, const Situation& now, const HandOverParams& params) {
  if (state.phase == Phase::kFlying) return Action::kPilot;
  if (state.phase == Phase::kEnding) {
    const bool knows_attitude = now.attitude_age <= params.attitude;
    const bool brakes = knows_attitude && now.time - state.since < params.brake;
    return brakes ? Action::kBrake : Action::kDescend;
  }
  if (state.flown) return Action::kDescend;
  // A program that has sent nothing does not begin at its end: the controller may be somebody else's.
  const bool silent =
      state.phase == Phase::kStarting || (state.phase == Phase::kOver && now.acknowledged == 0);
  return silent ? Action::kSilent : Action::kNeutral;
}

}  // namespace gatefly::guard
