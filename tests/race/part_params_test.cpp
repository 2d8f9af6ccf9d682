// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/part_params.hpp"

#include <gtest/gtest.h>

namespace gatefly {
namespace {

PilotConfig with_gates(double side, double bar, double body_radius) {
  PilotConfig config;
  config.track.gates = {{.p_EG = {6, 0, -0.5 * side - 0.2}, .side = side, .bar = bar}};
  config.plan.body_radius = body_radius;
  return config;
}

TEST(PhaseParams, AreAsTheyStandForGatesOfOneMetreAndSmallerOnes) {
  const PhaseParams usual;
  for (const double side : {0.8, 1.0}) {
    const PhaseParams params = phase_params(with_gates(side, 0.05, 0.20));
    EXPECT_DOUBLE_EQ(params.wait_before, usual.wait_before) << side;
    EXPECT_DOUBLE_EQ(params.max_miss, usual.max_miss) << side;
    EXPECT_DOUBLE_EQ(params.max_lateral_sigma, usual.max_lateral_sigma) << side;
  }
}

// 2.7 m outside, an opening of 1.5 m, a drone of 0.46 m: 0.52 m on either side in place of 0.25.
TEST(PhaseParams, OfLargeGatesWaitFartherOffAndLetPassWhatFits) {
  const PhaseParams usual, params = phase_params(with_gates(2.7, 0.6, 0.23));
  EXPECT_NEAR(params.wait_before, 2.7 * usual.wait_before, 1e-9);
  EXPECT_NEAR(params.search_before, 2.7 * usual.search_before, 1e-9);
  EXPECT_NEAR(params.search_until, 2.7 * usual.search_until, 1e-9)
      << "nearer nothing of it is in view";
  EXPECT_NEAR(params.max_miss / usual.max_miss, 0.52 / 0.25, 1e-9);
  EXPECT_LT(params.max_miss, 0.52) << "still inside the opening";
  EXPECT_NEAR(params.max_lateral_sigma / usual.max_lateral_sigma, 0.52 / 0.25, 1e-9);
}

// The smallest gate of a course counts.
TEST(PhaseParams, FollowTheSmallestGate) {
  PilotConfig config = with_gates(2.7, 0.6, 0.2);
  config.track.gates.push_back({.p_EG = {12, 0, -1.5}});
  EXPECT_DOUBLE_EQ(phase_params(config).wait_before, PhaseParams{}.wait_before);
}

}  // namespace
}  // namespace gatefly
