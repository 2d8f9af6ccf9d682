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
          any(), {any(), any(), any()}, std::chrono::milliseconds{rng.uniform_index(1000)}};
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

TEST(CommandGuard, FromTwoMetresASecondItStopsWithinTwoMetresAndIsOnTheFloorWithoutEverClimbing) {
  CommandGuard guard;
  Vector3d v_E{2, 0, 0}, p_E{0, 0, -1.5};
  double highest = 1.5, t = 0;
  for (; p_E.z() < 0 && t < 10; t += kDt) {
    const Belief belief{.v_E = v_E,
                        .height_age = std::chrono::milliseconds{static_cast<int>(t * 1000)}};
    const AttitudeCommand sent =
        guard.step(t < 1 ? Action::kBrake : Action::kDescend, {}, belief, kDt);
    v_E += kDt * acceleration(sent);
    p_E += kDt * v_E;
    highest = std::max(highest, -p_E.z());
  }
  EXPECT_LT(p_E.head<2>().norm(), 2.0);
  EXPECT_LT(highest, 1.5 + 1e-3);
  EXPECT_LT(v_E.z(), 0.8) << "gently";
  EXPECT_LT(t, 4.0);
}

TEST(CommandGuard, AFallMayBeStoppedThoughNothingTellsTheHeight) {
  CommandGuard guard;
  (void)guard.step(Action::kPilot, {.thrust = kGravity}, {.v_E = {0, 0, 1}},
                   kDt);  // sinks, as a gate said
  const AttitudeCommand sent = guard.step(Action::kPilot, {.thrust = kGravity + 1.5},
                                          {.v_E = {0, 0, 1}, .height_age = 1s}, kDt);
  EXPECT_NEAR(sent.thrust, kGravity + 1.5, 1e-9);
}

}  // namespace
}  // namespace gatefly::guard
