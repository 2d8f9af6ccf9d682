// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/hand_over.hpp"

#include <chrono>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "gatefly/geometry/rng.hpp"

#include "support/for_all.hpp"

namespace gatefly::guard {
namespace {

using namespace std::chrono_literals;
using test::for_all;

constexpr HandOverParams kHandOver{.least_battery_v = 20.0};

Situation in_flight() {
  return {.time = 10s,
          .hand_over_tested = true,
          .course_can_be_flown = true,
          .armed = true,
          .override_on = true,
          .acknowledged = 400,
          .status_age = 50ms,
          .attitude_age = 20ms,
          .picture_age = 40ms,
          .command_age = 10ms,
          .height_age = 100ms,
          .battery_v = 22.0};
}
constexpr HandOver kFlying{
    .phase = Phase::kFlying, .since = 5s, .override_was = true, .flown = true};

TEST(HandOver, WhateverFailsInFlightEndsItWithItsReasonInTheSamePeriod) {
  const auto ends = [](auto change) {
    Situation now = in_flight();
    change(now);
    const HandOver after = next(kFlying, now, kHandOver);
    EXPECT_EQ(after.phase, Phase::kEnding);
    return after.reason;
  };
  EXPECT_EQ(next(kFlying, in_flight(), kHandOver).phase, Phase::kFlying);
  EXPECT_EQ(ends([](Situation& s) { s.command_age = 60ms; }), Reason::kPilotLate);
  EXPECT_EQ(ends([](Situation& s) { s.picture_age = 200ms; }), Reason::kPicturesStale);
  EXPECT_EQ(ends([](Situation& s) { s.attitude_age = 160ms; }), Reason::kAttitudeStale);
  EXPECT_EQ(ends([](Situation& s) { s.status_age = 600ms; }), Reason::kStatusStale);
  EXPECT_EQ(ends([](Situation& s) { s.tilt = 1.2; }), Reason::kTilt);
  EXPECT_EQ(ends([](Situation& s) { s.tilt = std::numeric_limits<double>::quiet_NaN(); }),
            Reason::kTilt);
  EXPECT_EQ(ends([](Situation& s) { s.inside_fence = false; }), Reason::kFence);
  EXPECT_EQ(ends([](Situation& s) { s.battery_v = 19.9; }), Reason::kBattery);
  EXPECT_EQ(ends([](Situation& s) { s.told_to_end = true; }), Reason::kTold);
  EXPECT_EQ(ends([](Situation& s) { s.time = 10min; }), Reason::kTime);
  EXPECT_EQ(ends([](Situation& s) { s.height_age = 9s, s.time = 15s; }), Reason::kHeightLost);
}

TEST(HandOver, OnlyOfASimulatorIsAnEndingGivenUp) {
  const HandOver ending{.phase = Phase::kEnding, .reason = Reason::kTold, .since = 5s};
  HandOverParams simulator = kHandOver;
  simulator.gone = 5s, simulator.ending = 30s;
  Situation now = in_flight();
  now.time = 30s;
  EXPECT_EQ(next(ending, now, simulator).phase, Phase::kEnding);
  now.status_age = 6s;
  EXPECT_EQ(next(ending, now, simulator).phase, Phase::kOver) << "it has gone";
  EXPECT_EQ(next(ending, now, kHandOver).phase, Phase::kEnding);
  now.status_age = 50ms, now.time = 36s;
  EXPECT_EQ(next(ending, now, simulator).phase, Phase::kOver) << "it never disarms";
  now.time = 1h;
  EXPECT_EQ(next(ending, now, kHandOver).phase, Phase::kEnding) << "somebody may be in the air";
}

TEST(HandOver, ThePilotsSwitchWinsInEveryPhase) {
  Situation now = in_flight();
  now.override_on = false;
  EXPECT_EQ(next(kFlying, now, kHandOver).phase, Phase::kStreaming);
  const HandOver ending{.phase = Phase::kEnding,
                        .reason = Reason::kTilt,
                        .since = 9s,
                        .override_was = true,
                        .flown = true};
  EXPECT_EQ(next(ending, now, kHandOver).phase, Phase::kOver);
  now = in_flight();
  now.armed = false;
  EXPECT_EQ(next(ending, now, kHandOver).phase, Phase::kOver);
}

TEST(HandOver, AnOldStatusIsNotThePilotsWill) {
  Situation now = in_flight();
  now.armed = now.override_on = false;
  now.status_age = 5s;
  const HandOver ending{.phase = Phase::kEnding,
                        .reason = Reason::kStatusStale,
                        .since = 9s,
                        .override_was = true,
                        .flown = true};
  EXPECT_EQ(next(ending, now, kHandOver).phase, Phase::kEnding);
}

TEST(HandOver, BrakesForASecondAndThenDescendsForAsLongAsItTakes) {
  const HandOver ending{.phase = Phase::kEnding,
                        .reason = Reason::kTold,
                        .since = 10s,
                        .override_was = true,
                        .flown = true};
  Situation now = in_flight();
  EXPECT_EQ(action_of(ending, now, kHandOver), Action::kBrake);
  now.time = 10'990ms;
  EXPECT_EQ(action_of(ending, now, kHandOver), Action::kBrake);
  now.time = 11s;
  EXPECT_EQ(action_of(ending, now, kHandOver), Action::kDescend);
  now.time = 100s;
  EXPECT_EQ(action_of(next(ending, now, kHandOver), now, kHandOver), Action::kDescend);
}

TEST(HandOver, InTheAirFramesAreNeverNeutralWhoeverFlies) {
  Situation now = in_flight();
  now.override_on = false;
  HandOver state = next(kFlying, now, kHandOver);
  EXPECT_EQ(action_of(state, now, kHandOver), Action::kDescend)
      << "for when the switch goes back on";
  now.override_on = true;
  now.picture_age = 1s;  // it must not fly now
  state = next(state, now, kHandOver);
  EXPECT_EQ(state.reason, Reason::kPicturesStale);
  EXPECT_EQ(action_of(state, now, kHandOver), Action::kDescend);
  now.armed = false;  // on the floor, by the pilot's word
  EXPECT_EQ(action_of(next(state, now, kHandOver), now, kHandOver), Action::kNeutral);
}

/// Anything may happen in any period: what must never be, is not.
TEST(HandOver, WhateverHappensThePilotsCommandIsSentOnlyWhenAllIsWell) {
  for_all(500, [](Rng& rng) {
    HandOver state;
    Situation now = in_flight();
    now.acknowledged = 0;
    now.armed = now.override_on = false;
    bool ended = false;
    for (int i = 0; i < 400; ++i) {
      now.time += 25ms;
      const auto perhaps = [&](int one_in) { return rng.uniform_index(one_in) == 0; };
      if (perhaps(40)) now.armed = !now.armed;
      if (perhaps(30)) now.override_on = !now.override_on;
      now.attitude_age = perhaps(200) ? 100ms : 20ms;
      now.command_age = perhaps(200) ? 100ms : 10ms;
      now.picture_age = perhaps(200) ? 300ms : 40ms;
      now.told_to_end = now.told_to_end || perhaps(2000);
      const HandOver before = state;
      state = next(state, now, kHandOver);
      const Action action = action_of(state, now, kHandOver);
      ended = ended || state.phase == Phase::kEnding || state.phase == Phase::kOver;
      if (action == Action::kPilot) {
        EXPECT_TRUE(now.armed && now.override_on && !now.told_to_end && !ended);
        EXPECT_LE(now.attitude_age, kHandOver.attitude);
        EXPECT_LE(now.command_age, kHandOver.command);
        EXPECT_LE(now.picture_age, kHandOver.picture);
        EXPECT_GE(now.acknowledged, kHandOver.neutral_frames);
      }
      EXPECT_TRUE(action != Action::kNeutral || !state.flown);
      // Once something was sent, something is sent in every period.
      EXPECT_TRUE(now.acknowledged == 0 || action != Action::kSilent);
      EXPECT_TRUE(before.phase != Phase::kOver || state.phase == Phase::kOver);
      if (action != Action::kSilent) ++now.acknowledged;
    }
  });
}

TEST(HandOver, EveryReasonHasALineOfItsOwn) {
  std::set<std::string> lines;
  for (int i = 0; i <= static_cast<int>(Reason::kTold); ++i)
    lines.insert(std::string{text_of(static_cast<Reason>(i))});
  EXPECT_EQ(lines.size(), static_cast<std::size_t>(Reason::kTold) + 1);
}

}  // namespace
}  // namespace gatefly::guard
