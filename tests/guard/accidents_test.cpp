// SPDX-License-Identifier: Apache-2.0
// Accidents that destroyed drones at the AI Grand Prix's physical qualifier, or would have: each happens here
// without its guard, and does not with it.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/guard/answer_watch.hpp"
#include "gatefly/guard/axis_check.hpp"
#include "gatefly/guard/command_guard.hpp"
#include "gatefly/guard/hand_over.hpp"
#include "gatefly/link/msp_axes.hpp"
#include "gatefly/link/rate_curve.hpp"

#include "support/for_all.hpp"

namespace gatefly::guard {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using test::for_all;

constexpr auto kPeriod = 25ms;
constexpr HandOverParams kParams{};

/// A drone on the floor with everything as it should be.
Situation well() {
  return {.hand_over_tested = true,
          .course_can_be_flown = true,
          .status_age = 50ms,
          .attitude_age = 20ms,
          .picture_age = 40ms,
          .command_age = 10ms,
          .height_age = 100ms};
}

/// Situation after situation.
class Periods {
 public:
  Situation now = well();
  HandOver state;

  Action step() {
    now.time += kPeriod;
    state = next(state, now, kParams);
    const Action action = action_of(state, now, kParams);
    if (action != Action::kSilent) ++now.acknowledged;
    return action;
  }
  Action steps(int count) {
    Action action = Action::kSilent;
    while (count-- > 0) action = step();
    return action;
  }
  /// Neutral frames, armed, overridden: flying.
  void take_off() {
    steps(60);
    now.armed = true;
    steps(10);
    now.override_on = true;
    ASSERT_EQ(step(), Action::kPilot);
  }
};

// The curve as a line ----------------------------------------------------------------------------------------------------

const msp::RateCurve kQualifier{.rc_rate = 55, .super_rate = 75};

/// The rate at which the drone turns for a wanted one: the drone turns by its curve, whatever its sender believes.
double loop_gain(const std::function<int(double)>& stick_of, double wanted) {
  return kQualifier.rate(stick_of(wanted)) / wanted;
}

TEST(Accident, CurveTakenForALine) {
  const auto line = [](double rate) {
    return 1500 + static_cast<int>(500 * rate / (440 * kDegree));
  };
  EXPECT_LT(loop_gain(line, 50 * kDegree), 0.5);
  for (double wanted = 5; wanted < 440; wanted += 5)
    EXPECT_NEAR(loop_gain([](double rate) { return kQualifier.stick(rate); }, wanted * kDegree),
                1.0, 0.05)
        << wanted;
}

// Axes and scales --------------------------------------------------------------------------------------------------------

/// Turned by hand about one axis after the other; the gyro as `gyro_of` has it, the attitude as MSP sends it.
AxisCheck turned_by_hand(const std::function<Vector3d(const Vector3d&)>& gyro_of) {
  AxisCheck check;
  Quaternion q;
  const auto turn = [&](const Vector3d& rate_B, int samples) {
    for (int i = 0; i < samples; ++i) {
      q = integrated(q, rate_B, 0.025);
      const Attitude a = attitude_of(rotation_EB(q));
      const msp::Attitude sent{
          .roll = static_cast<std::int16_t>(std::lround(a.roll / kDegree * 10)),
          .pitch = static_cast<std::int16_t>(std::lround(-a.pitch / kDegree * 10)),
          .yaw = static_cast<std::int16_t>(std::lround(a.yaw / kDegree))};
      check.take(gyro_of(rate_B), msp::attitude_of(sent), 0.025);
    }
  };
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
    turn(axis, 40);
    turn(-axis, 40);
    turn({0, 0, 0}, 20);
  }
  return check;
}

TEST(Accident, NoneWithAHealthyGyro) {
  const AxisCheck check = turned_by_hand([](const Vector3d& rate) { return rate; });
  EXPECT_TRUE(check.all_agree());
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(*check.scale(axis), 1.0, 0.05);
}

TEST(Accident, PitchInverted) {
  const AxisCheck check =
      turned_by_hand([](const Vector3d& r) { return Vector3d(r.x(), -r.y(), r.z()); });
  EXPECT_EQ(check.verdict(0), AxisVerdict::kAgrees);
  EXPECT_EQ(check.verdict(1), AxisVerdict::kOpposite);
  EXPECT_EQ(check.verdict(2), AxisVerdict::kAgrees);
  EXPECT_FALSE(check.all_agree());
}

TEST(Accident, CountsTakenForDegrees) {
  for (const double scale : {16.384, 1 / 16.384, 57.3, 0.5}) {
    const AxisCheck check = turned_by_hand([&](const Vector3d& r) { return Vector3d(scale * r); });
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(check.verdict(axis), AxisVerdict::kWrongScale) << scale;
  }
}

TEST(Accident, AxesSwappedOrDead) {
  const AxisCheck swapped =
      turned_by_hand([](const Vector3d& r) { return Vector3d(r.y(), r.x(), r.z()); });
  EXPECT_EQ(swapped.verdict(0), AxisVerdict::kOtherAxis);
  EXPECT_EQ(swapped.verdict(1), AxisVerdict::kOtherAxis);
  EXPECT_EQ(swapped.verdict(2), AxisVerdict::kAgrees);
  const AxisCheck dead =
      turned_by_hand([](const Vector3d& r) { return Vector3d(r.x(), 0, r.z()); });
  EXPECT_EQ(dead.verdict(1), AxisVerdict::kDead);
  EXPECT_EQ(AxisCheck{}.verdict(0), AxisVerdict::kNotTurned);
}

// Permission to send ------------------------------------------------------------------------------------------------------

TEST(Accident, BufferOfZerosWhenTheOverrideComesOn) {
  Periods run;
  EXPECT_EQ(run.step(), Action::kNeutral) << "frames from the first period on";
  run.now.armed = true;
  run.steps(10);
  run.now.override_on = true;  // ten frames are not enough to know that they arrive
  EXPECT_EQ(run.steps(100), Action::kNeutral);
  EXPECT_EQ(run.state.reason, Reason::kTooEarly);
  run.now.override_on = false;
  run.step();
  run.now.override_on = true;
  EXPECT_EQ(run.step(), Action::kPilot);
}

TEST(Accident, FramesThatTheControllerDoesNotAnswerDoNotCount) {
  Periods run;
  for (int i = 0; i < 500; ++i) run.step(), run.now.acknowledged = 3;
  run.now.armed = true;
  run.step();
  run.now.override_on = true;
  EXPECT_EQ(run.step(), Action::kNeutral);
}

TEST(Accident, ArmedAtStart) {
  Periods run;
  run.now.armed = true;
  EXPECT_EQ(run.steps(100), Action::kSilent);
  EXPECT_EQ(run.state.reason, Reason::kArmedAtStart);
  run.now.armed = false;
  EXPECT_EQ(run.steps(100), Action::kSilent) << "a new start is needed";
}

TEST(Accident, OverrideOnAtStart) {
  Periods run;
  run.now.override_on = true;
  EXPECT_EQ(run.steps(100), Action::kSilent);
  EXPECT_EQ(run.state.reason, Reason::kOverrideAtStart);
}

TEST(Accident, StartWithoutAHandOverTestOrACourseOrAnAnswer) {
  Periods run;
  run.now.hand_over_tested = false;
  EXPECT_EQ(run.steps(3), Action::kSilent);
  EXPECT_EQ(run.state.reason, Reason::kNotTested);
  Periods course;
  course.now.course_can_be_flown = false;
  EXPECT_EQ(course.steps(3), Action::kSilent);
  EXPECT_EQ(course.state.reason, Reason::kCourse);
  Periods silent;
  silent.now.status_age = Situation::kNever;
  EXPECT_EQ(silent.steps(3), Action::kSilent);
  silent.now.status_age = 10ms;
  EXPECT_EQ(silent.step(), Action::kNeutral) << "it was only slow";
}

TEST(Accident, SwitchesInTheWrongOrder) {
  Periods run;
  run.steps(60);
  run.now.override_on = true;  // before arming
  EXPECT_EQ(run.steps(5), Action::kNeutral);
  EXPECT_EQ(run.state.reason, Reason::kSwitchOrder);
  run.now.armed = true;  // would take off at once
  EXPECT_EQ(run.steps(100), Action::kNeutral);
  run.now.override_on = false;
  EXPECT_EQ(run.steps(3), Action::kNeutral);
  run.now.override_on = true;
  EXPECT_EQ(run.step(), Action::kPilot);
}

TEST(Accident, ASecondClient) {
  AnswerWatch watch;
  for (int i = 0; i < 100; ++i) {
    watch.asked(108);
    watch.asked(102);
    watch.answered(108);
    watch.answered(102);
  }
  watch.asked(108);  // lost
  EXPECT_FALSE(watch.other_client());
  watch.answered(2);  // what a configurator asks
  watch.answered(110);
  EXPECT_TRUE(watch.other_client());

  Periods on_the_floor;
  on_the_floor.steps(60);
  on_the_floor.now.other_client = true;
  on_the_floor.step();
  EXPECT_EQ(on_the_floor.state.phase, Phase::kOver);
  Periods in_flight;
  in_flight.take_off();
  in_flight.now.other_client = true;
  EXPECT_EQ(in_flight.step(), Action::kBrake);
  EXPECT_EQ(in_flight.state.reason, Reason::kOtherClient);
}

TEST(Accident, AttitudeThatIsOldOrStuck) {
  SampleWatch watch;
  EXPECT_FALSE(watch.age(0ms));
  const std::array<std::uint8_t, 3> one{1, 2, 3}, other{1, 2, 4};
  watch.arrived(one, 0ms);
  watch.arrived(other, 25ms);
  for (int i = 2; i < 8; ++i) watch.arrived(other, i * 25ms);
  EXPECT_EQ(*watch.age(275ms), 250ms) << "samples arrive, always the same";

  Periods run;
  run.take_off();
  run.now.attitude_age = *watch.age(275ms);
  EXPECT_EQ(run.step(), Action::kDescend)
      << "whoever does not know the attitude does not brake by it";
  EXPECT_EQ(run.state.reason, Reason::kAttitudeStale);
  run.now.attitude_age = 20ms;
  EXPECT_EQ(run.steps(10), Action::kBrake) << "it does not fly on";
}

// Height -----------------------------------------------------------------------------------------------------------------

/// Climbs [m] in five seconds of a pilot that holds its height by an accelerometer alone, off by `bias` [m/s²].
double climb_without_gates(double bias, bool guarded) {
  CommandGuard guard;
  double height = 0, up = 0, believed_height = 0, believed_up = 0;
  constexpr double kDt = 0.025;
  for (int i = 0; i < 200; ++i) {
    const double correction = std::clamp(-2 * believed_height - 3 * believed_up, -3.0, 3.0);
    AttitudeCommand command{.thrust = kGravity + correction};
    if (guarded)
      command = guard.step(Action::kPilot, command,
                           {.v_E = {0, 0, -believed_up}, .height_age = i * kPeriod}, kDt);
    const double acceleration = command.thrust - kGravity;
    up += kDt * acceleration, height += kDt * up;
    believed_up += kDt * (acceleration + bias), believed_height += kDt * believed_up;
  }
  return height;
}

TEST(Accident, HeightIntegratedWhileNoGateIsSeen) {
  // The qualifier's accelerometer at a throttle of 0.45: −0.46 · 0.2 g.
  EXPECT_GT(climb_without_gates(-0.9, false), 5.0) << "through the ceiling";
  EXPECT_LT(climb_without_gates(-0.9, true), 0.5);
  EXPECT_NEAR(climb_without_gates(0.0, true), 0.0, 1e-9) << "a good one is left alone";
}

TEST(Accident, NoHeightForTooLongEndsTheFlight) {
  Periods run;
  run.take_off();
  for (int i = 0; i < 400 && run.state.phase == Phase::kFlying; ++i) {
    run.now.height_age = (i + 1) * kPeriod;
    run.step();
  }
  EXPECT_EQ(run.state.phase, Phase::kEnding);
  EXPECT_EQ(run.state.reason, Reason::kHeightLost);
}

}  // namespace
}  // namespace gatefly::guard
