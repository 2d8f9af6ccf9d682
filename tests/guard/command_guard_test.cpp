// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/command_guard.hpp"

#include <chrono>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly::guard {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using test::for_all;

constexpr double kDt = 0.025;

/// Acceleration in E of a drone that has the attitude it is told.
Vector3d acceleration(const AttitudeCommand& c) {
  return rotation_EB(Attitude{c.roll, c.pitch, c.yaw}) * Vector3d(0, 0, -c.thrust) +
         Vector3d(0, 0, kGravity);
}

TEST(CommandGuard, ACommandWithinLimitsIsSentAsItIs) {
  CommandGuard guard;
  const AttitudeCommand wanted{.roll = 0.2, .pitch = -0.3, .yaw = 1, .yaw_rate = 0.5, .thrust = 11};
  const AttitudeCommand sent = guard.step(Action::kPilot, wanted, {}, kDt);
  EXPECT_EQ(sent.roll, 0.2);
  EXPECT_EQ(sent.pitch, -0.3);
  EXPECT_EQ(sent.yaw_rate, 0.5);
  EXPECT_EQ(sent.thrust, 11);
}

TEST(CommandGuard, WhateverIsAskedForIsWithinLimitsAndANumber) {
  for_all(300, [](Rng& rng) {
    CommandGuard guard;
    const CommandLimits limits;
    for (int i = 0; i < 50; ++i) {
      const auto any = [&] {
        constexpr double kOdd[] = {std::numeric_limits<double>::quiet_NaN(),
                                   std::numeric_limits<double>::infinity(), -1e300, 1e300};
        return rng.uniform_index(8) == 0 ? kOdd[rng.uniform_index(4)] : rng.uniform(-30, 30);
      };
      const AttitudeCommand wanted{any(), any(), any(), any(), any()};
      const Belief belief{
          any(), {any(), any(), any()}, any(), std::chrono::milliseconds{rng.uniform_index(1000)}};
      const auto action = static_cast<Action>(rng.uniform_index(5));
      const AttitudeCommand sent = guard.step(action, wanted, belief, any());
      EXPECT_LE(std::abs(sent.roll), limits.tilt);
      EXPECT_LE(std::abs(sent.pitch), limits.tilt);
      EXPECT_TRUE(sent.thrust >= 0 && sent.thrust <= limits.thrust);
      EXPECT_TRUE(std::isfinite(sent.yaw) && std::isfinite(sent.yaw_rate));
      EXPECT_TRUE(action >= Action::kPilot || sent.thrust == 0.0);
    }
  });
}

TEST(CommandGuard, BrakingPushesAgainstTheVelocityWhateverTheHeading) {
  for_all(200, [](Rng& rng) {
    CommandGuard guard;
    const Vector3d v_E{rng.uniform(-5, 5), rng.uniform(-5, 5), 0};
    if (v_E.norm() < 0.5) return test::not_a_case();
    const Belief belief{.yaw = rng.uniform(-kPi, kPi), .v_E = v_E};
    const Vector3d a_E = acceleration(guard.step(Action::kBrake, {}, belief, kDt));
    EXPECT_LT(a_E.head<2>().dot(v_E.head<2>()), 0.0);
    const double along = std::abs(a_E.head<2>().normalized().dot(v_E.head<2>().normalized()));
    EXPECT_GT(along, 0.7) << "the limit is one for each axis";
  });
}

/// An ending from `height`, as it goes: a second of braking, then a descent; rotors with a lag, that give `error` more than is thought.
struct Ending {
  double highest = 0, touch_speed = 0, time = 0, distance = 0;
};
Ending ended(double height, const Vector3d& velocity_E, double error, double drag) {
  constexpr int kSteps = 25;  // of a millisecond
  CommandGuard guard;
  Vector3d v_E = velocity_E, p_E{0, 0, -height};
  Ending ending{.highest = height};
  const Belief before{.v_E = v_E};
  (void)guard.step(Action::kPilot, {.thrust = kGravity}, before, kDt);
  Vector3d thrust_E{0, 0, -kGravity};
  for (; p_E.z() < 0 && ending.time < 30; ending.time += kDt) {
    const Belief belief{.v_E = v_E, .height_age = std::chrono::hours{1}};
    const AttitudeCommand sent =
        guard.step(ending.time < 1 ? Action::kBrake : Action::kDescend, {}, belief, kDt);
    const Vector3d wanted_E = (1 + error) * (acceleration(sent) - Vector3d(0, 0, kGravity));
    for (int i = 0; i < kSteps && p_E.z() < 0; ++i) {
      constexpr double dt = kDt / kSteps;
      thrust_E += dt / 0.04 * (wanted_E - thrust_E);
      v_E += dt * (thrust_E + Vector3d(0, 0, kGravity) - drag * v_E);
      p_E += dt * v_E;
      ending.highest = std::max(ending.highest, -p_E.z());
    }
  }
  ending.touch_speed = v_E.z();
  ending.distance = p_E.head<2>().norm();
  return ending;
}

TEST(CommandGuard, AnEndingNeverClimbsAndIsOnTheFloorWithHoverThrustTenPercentOff) {
  for (const double drag : {0.1, 0.3, 0.9})
    for (const double error : {-0.1, -0.05, 0.0, 0.05, 0.1}) {
      SCOPED_TRACE(testing::Message() << "drag " << drag << ", hover thrust off by " << error);
      const Ending ending = ended(1.5, {2, 0, 0}, error, drag);
      EXPECT_LT(ending.highest, 1.5 + 0.05);
      EXPECT_LT(ending.time, drag < 0.5 ? 3.0 : 4.0);
      EXPECT_LT(ending.touch_speed, 2.5) << "as a fall from 0.3 m";
      EXPECT_LT(ending.distance, 2.0);
    }
  const Ending nominal = ended(1.5, {0, 0, 0}, 0.0, 0.3), strong = ended(1.5, {0, 0, 0}, 0.1, 0.3);
  EXPECT_LT(nominal.touch_speed, 1.65);
  EXPECT_LT(nominal.time, 1.8);
  EXPECT_LT(strong.touch_speed, 0.9);
  EXPECT_LT(ended(4.0, {2, 0, 0}, 0.1, 0.3).touch_speed, 3.4)
      << "its lift has faded: as a fall from 0.6 m";
}

TEST(CommandGuard, AnEndingStopsAClimbThatIsKnown) {
  const Ending ending = ended(1.5, {0, 0, -1}, 0.1, 0.3);
  EXPECT_LT(ending.highest, 1.5 + 0.45) << "without its margin it would be 5 m";
  EXPECT_LT(ending.time, 4.0);
}

TEST(CommandGuard, NothingHoldsItUpForEver) {
  CommandGuard guard;
  double thrust = kGravity;
  for (double t = 0; t < 20; t += kDt) thrust = guard.step(Action::kDescend, {}, {}, kDt).thrust;
  EXPECT_LT(thrust, 0.25 * kGravity);
}

TEST(CommandGuard, AFallMayBeStoppedThoughNothingTellsTheHeight) {
  CommandGuard guard;
  (void)guard.step(Action::kPilot, {.thrust = kGravity}, {.v_E = {0, 0, 1}},
                   kDt);  // sinks, as a gate said
  const AttitudeCommand sent = guard.step(Action::kPilot, {.thrust = kGravity + 1.5},
                                          {.v_E = {0, 0, 1}, .height_age = 1s}, kDt);
  EXPECT_NEAR(sent.thrust, kGravity + 1.5, 1e-9);
}

/// Height [m] above where a gate was last seen, after so many seconds: a pilot that wants its height back, rotors that give `strength` of what
/// is thought, an accelerometer off by `bias` [m/s²] of which the filter thinks that it is off by `bias_sigma`.
double risen(double seconds, double strength, double bias, double bias_sigma) {
  CommandGuard guard;
  double height = 0, up = 0, believed_height = 0, believed_up = 0;
  (void)guard.step(Action::kPilot, {.thrust = kGravity}, {}, kDt);
  for (double t = 0; t < seconds; t += kDt) {
    const double wanted = kGravity + std::clamp(-2 * believed_height - 3 * believed_up, -3.0, 3.0);
    const std::chrono::milliseconds age{std::lround(1e3 * t)};
    const AttitudeCommand sent = guard.step(
        Action::kPilot, {.thrust = wanted},
        {.v_E = {0, 0, -believed_up}, .climb_sigma = bias_sigma * t, .height_age = age}, kDt);
    const double acceleration = strength * sent.thrust - kGravity;
    up += kDt * acceleration, height += kDt * up;
    believed_up += kDt * (acceleration + bias), believed_height += kDt * believed_up;
  }
  return height;
}

TEST(CommandGuard, AFallThatTheFilterIsSureOfIsStopped) {
  EXPECT_LT(risen(3, 0.96, 0.0, 1e9), -1.2) << "without the filter's word it sinks";
  EXPECT_GT(risen(3, 0.96, 0.0, 0.03), -0.4) << "rotors that are weaker by 4 %";
  EXPECT_NEAR(risen(3, 1.0, 0.0, 0.03), 0.0, 1e-9);
  EXPECT_GT(risen(3, 1.05, 0.0, 0.03), -0.1) << "nor do stronger ones matter";
}

TEST(CommandGuard, AFilterThatIsSureAndWrongRaisesTheDroneByTwoMetresAndNoMore) {
  for (const double bias : {-0.3, -0.9, -2.0})
    EXPECT_LT(risen(8, 1.0, bias, 0.0) - risen(8, 1.0, bias, 1e9), 2.1) << bias;
  EXPECT_LT(risen(3, 1.0, -0.09, 0.03), 0.4) << "wrong by three sigma";
}

/// Rotors that are stronger than told hover with less: the pilot has found that out, and holds its height with 0.93 of the weight.
TEST(CommandGuard, AFallThatNothingHasMeasuredIsNotMadeUpFor) {
  CommandGuard guard;
  const AttitudeCommand hovers{.thrust = 0.93 * kGravity};
  (void)guard.step(Action::kPilot, hovers, {}, kDt);  // a gate, and none for six seconds
  std::chrono::milliseconds age = 0ms;
  for (double t = 0; t < 6; t += kDt, age += 25ms)
    (void)guard.step(Action::kPilot, hovers, {.height_age = age}, kDt);
  for (double t = 0; t < 1; t += kDt) {
    const AttitudeCommand sent = guard.step(Action::kBrake, {}, {.height_age = age}, kDt);
    EXPECT_LT(sent.thrust, hovers.thrust) << "it would climb, " << t << " s later";
  }
}

/// The lift that a guard allows, and a descent's, after eight seconds of a pilot's lift while gates tell the height.
struct Learnt {
  double allowed = 0.0, descent = 0.0;
};
Learnt learnt(double part, double climb_a_second = 0.0) {
  CommandGuard guard;
  Vector3d v_E = Vector3d::Zero();
  for (double t = 0; t < 8; t += kDt, v_E.z() -= climb_a_second * kDt)
    (void)guard.step(Action::kPilot, {.thrust = part * kGravity}, {.v_E = v_E}, kDt);
  CommandGuard ends = guard;
  (void)guard.step(Action::kPilot, {.thrust = part * kGravity}, {}, kDt);
  return {guard.step(Action::kPilot, {.thrust = 2 * kGravity}, {.height_age = 1s}, kDt).thrust,
          ends.step(Action::kDescend, {}, {}, kDt).thrust};
}

TEST(CommandGuard, LearnsWhatHoversWhileGatesTellTheHeight) {
  const Learnt nominal = learnt(1.0), strong = learnt(0.9), weak = learnt(1.1);
  EXPECT_NEAR(nominal.allowed, kGravity, 0.01 * kGravity);
  EXPECT_NEAR(strong.allowed, 0.9 * kGravity, 0.02 * kGravity);
  EXPECT_NEAR(weak.allowed, 1.1 * kGravity, 0.02 * kGravity) << "less would let it sink";
  EXPECT_NEAR(strong.descent, 0.9 * nominal.descent, 0.02 * kGravity);
  EXPECT_LE(weak.descent, nominal.descent + 1e-9) << "an ending goes by the strongest";
}

TEST(CommandGuard, APilotThatClimbsOrDivesShowsNothing) {
  EXPECT_NEAR(learnt(1.03, 0.03 * kGravity).allowed, kGravity, 0.03 * kGravity);
  EXPECT_LT(learnt(1.5).allowed, 1.31 * kGravity);
  EXPECT_GT(learnt(0.3).descent, 0.75 * learnt(1.0).descent);
}

TEST(CommandGuard, APilotThatStandsIsSetDown) {
  CommandGuard guard, in_the_air;
  const double sets_down = guard.step(Action::kDescend, {}, {.stands = true}, kDt).thrust;
  EXPECT_LT(sets_down, 0.9 * in_the_air.step(Action::kDescend, {}, {}, kDt).thrust);
  EXPECT_GT(sets_down, 0.6 * kGravity) << "it may be wrong by a decimetre or four";
}

}  // namespace
}  // namespace gatefly::guard
