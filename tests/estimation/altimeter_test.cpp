// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/altimeter.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace gatefly {
namespace {

// 10 s of hovering at 1.5 m, sonar at 20 Hz, barometer at 50 Hz with `drift`.
Altimeter hovering(double drift, double& time, double start = 0.0) {
  Altimeter altimeter{AltimeterParams{}};
  for (int i = 0; i < 500; ++i) {
    time = start + 0.02 * i;
    (void)altimeter.baro(1.5 + drift * (time - start) / 10, time);
    if (i % 2 == 0) (void)altimeter.sonar(1.5, 1.5, time);
  }
  return altimeter;
}

TEST(Altimeter, TrustsAnEchoOfTheFloor) {
  double time = 0;
  Altimeter altimeter = hovering(0.0, time);
  const auto height = altimeter.sonar(1.48, 1.5, time + 0.05);
  ASSERT_TRUE(height);
  EXPECT_EQ(height->value, 1.48);
  EXPECT_EQ(height->sigma, AltimeterParams{}.sonar_sigma);
}

TEST(Altimeter, ATableIsNotTheFloorHoweverLongItIs) {
  double time = 0;
  Altimeter altimeter = hovering(0.0, time);
  for (int i = 0; i < 60; ++i) {
    time += 0.05;
    (void)altimeter.baro(1.5, time);
    EXPECT_FALSE(altimeter.sonar(0.7, 1.5, time)) << i;
  }
  EXPECT_TRUE(altimeter.sonar(1.5, 1.5, time + 0.05)) << "and the floor is the floor again";
}

TEST(Altimeter, AfterALongWhileAnEchoThatTheBarometerConfirmsIsBelieved) {
  double time = 0;
  Altimeter altimeter = hovering(0.0, time);
  for (int i = 0; i < 100; ++i) {
    time += 0.02;
    (void)altimeter.baro(1.0, time);
  }
  EXPECT_TRUE(altimeter.sonar(1.0, 1.5, time)) << "the filter lost it";
}

TEST(Altimeter, FollowsTheBarometersSlowDrift) {
  double time = 0;
  Altimeter altimeter = hovering(0.3, time);
  const auto height = altimeter.baro(1.8, time + 0.02);
  ASSERT_TRUE(height);
  EXPECT_LT(height->value, 1.8 - 0.08) << "part of the drift is known by now";
  EXPECT_GT(height->value, 1.45);
}

TEST(Altimeter, WhenTheClockStartsDoesNotMatter) {
  double a = 0, b = 0;
  Altimeter early = hovering(0.0, a, 0.0), late = hovering(0.0, b, 5000.0);
  EXPECT_EQ(early.sonar(0.9, 1.5, a + 0.05).has_value(),
            late.sonar(0.9, 1.5, b + 0.05).has_value());
  Altimeter first_early{AltimeterParams{}}, first_late{AltimeterParams{}};
  EXPECT_EQ(first_early.sonar(0.9, 1.5, 0.0).has_value(),
            first_late.sonar(0.9, 1.5, 5000.0).has_value());
}

TEST(Altimeter, EchoesOfAClimbAreBelieved) {
  Altimeter altimeter{AltimeterParams{}};
  int refused = 0;
  for (int i = 0; i < 75; ++i) {  // 1 m/s for 1.5 s
    const double time = 0.02 * i, height = time;
    if (i > 0) altimeter.climb(0.02);
    (void)altimeter.baro(height, time);
    if (i % 2 == 0) refused += !altimeter.sonar(height, height, time);
  }
  EXPECT_EQ(refused, 0);
}

// A barometer that is off by 0.3 m and a sonar that sees the floor: after its time constant 63 % of
// that is known, however often the sonar speaks.
TEST(Altimeter, FollowsTheBarometersDriftInTheSameTimeAtAnySonarRate) {
  for (const double hz : {5.0, 20.0, 80.0}) {
    AltimeterParams params;
    params.sonar_hz = hz;
    Altimeter altimeter{params};
    const auto offset = [&](double time) { return altimeter.baro(1.8, time)->value - 1.5; };
    double time = 0.0;
    (void)altimeter.baro(1.8, time);
    const int echoes = static_cast<int>(params.drift_time * hz);
    for (int i = 1; i <= echoes; ++i) (void)altimeter.sonar(1.5, 1.5, time = i / hz);
    EXPECT_NEAR(offset(time) / 0.3, std::exp(-1.0), 0.02) << hz << " Hz";
  }
}

}  // namespace
}  // namespace gatefly
