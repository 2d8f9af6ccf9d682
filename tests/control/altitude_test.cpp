// SPDX-License-Identifier: Apache-2.0
#include "gatefly/control/altitude.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace gatefly {
namespace {

TEST(Altitude, AtItsHeightAsksForNothing) {
  Altitude altitude;
  EXPECT_EQ(altitude.step(-1.5, 0, -1.5, 0, 0.01, {}), 0.0);
}

TEST(Altitude, TooLowAsksForUpAndSinkingToo) {
  Altitude low, sinking;
  EXPECT_GT(low.step(-1.5, 0, -1.0, 0, 0.01, {}), 0) << "z is down";
  EXPECT_GT(sinking.step(-1.5, 0, -1.5, 0.5, 0.01, {}), 0);
}

TEST(Altitude, StaysWithinItsLimits) {
  const AltitudeParams params;
  Altitude altitude;
  for (int i = 0; i < 1000; ++i) {
    const double a = altitude.step(-1.5, 0, 50.0, 0, 0.1, params);
    ASSERT_LE(std::abs(a), params.max_accel);
  }
}

// Wound up against its limit for a long time, the integral is no more than max_integral.
TEST(Altitude, IntegralIsBoundedAndResetForgetsIt) {
  const AltitudeParams params;
  Altitude altitude;
  for (int i = 0; i < 10'000; ++i) (void)altitude.step(-1.5, 0, 0.0, 0, 0.1, params);
  EXPECT_NEAR(altitude.step(-1.5, 0, -1.5, 0, 0.0, params), params.max_integral, 1e-12);
  altitude.reset();
  EXPECT_EQ(altitude.step(-1.5, 0, -1.5, 0, 0.0, params), 0.0);
}

TEST(Altitude, NoTimeAddsNoIntegral) {
  Altitude a, b;
  for (int i = 0; i < 100; ++i) (void)a.step(-1.5, 0, -1.0, 0, 0.0, {});
  EXPECT_EQ(a.step(-1.5, 0, -1.0, 0, 0.01, {}), b.step(-1.5, 0, -1.0, 0, 0.01, {}));
}

// A weak battery lifts 0.5 m/s² less than asked: the integral carries it.
TEST(Altitude, HoldsTheHeightWithAWeakBattery) {
  Altitude altitude;
  double z = 0, vz = 0, highest = 0;
  const double dt = 1.0 / 512;
  for (int i = 0; i < 30 * 512; ++i) {
    const double up = altitude.step(-1.5, 0, z, vz, dt, {}) - 0.5;
    vz -= dt * up;
    z += dt * vz;
    highest = std::max(highest, -z);
  }
  EXPECT_NEAR(z, -1.5, 0.01);
  EXPECT_LT(highest, 1.5 + 0.35) << "overshoot of a 1.5 m step";
}

}  // namespace
}  // namespace gatefly
