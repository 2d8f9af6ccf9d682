// SPDX-License-Identifier: Apache-2.0
#include "gatefly/control/lateral_pd.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/for_all.hpp"

namespace gatefly {
namespace {

using test::for_all;

TEST(LateralPd, OnTheLineAndAlongItAsksForNothing) { EXPECT_EQ(lateral_roll(0, 0, {}), 0.0); }

TEST(LateralPd, RightOfTheLineRollsLeft) {
  EXPECT_LT(lateral_roll(0.5, 0, {}), 0);
  EXPECT_LT(lateral_roll(0, 0.5, {}), 0) << "drifting to the right";
}

TEST(LateralPd, MirroredApproachGivesMirroredCommandWithinTheLimit) {
  const LateralParams params;
  for_all(200, [&](Rng& rng) {
    const double y = rng.uniform(-5, 5), v = rng.uniform(-3, 3);
    EXPECT_EQ(lateral_roll(-y, -v, params), -lateral_roll(y, v, params));
    EXPECT_LE(std::abs(lateral_roll(y, v, params)), params.max_roll);
  });
  EXPECT_EQ(lateral_roll(1e300, 0, params), -params.max_roll);
}

// Flat dynamics ÿ = g tan(roll) + k ẏ, Li18 Eq. (23): from 0.8 m (the paper's arc error) onto the
// line.
TEST(LateralPd, BringsTheDroneOntoTheLineWithoutRinging) {
  double y = 0.8, v = 0, most = 0, after_four_seconds = 0;
  const double dt = 0.002;
  for (int i = 0; i < 3000; ++i) {
    const double roll = lateral_roll(y, v, {});
    v += dt * (9.81 * std::tan(roll) - 0.47 * v);
    y += dt * v;
    most = std::max(most, -y);
    if (i == 2000) after_four_seconds = std::abs(y);
  }
  EXPECT_LT(after_four_seconds, 0.02);
  EXPECT_LT(most, 0.05) << "overshoot";
  EXPECT_LT(std::abs(v), 0.02);
}

}  // namespace
}  // namespace gatefly
