// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/wide_gate_looks.hpp"

namespace gatefly::experiments {
namespace {

using Eigen::Vector2d;

/// 200 px wide and high, its upper left corner at (100, 50), cut off below.
sim::GateView cut_below() {
  sim::GateView gate;
  gate.corners_px = {Vector2d{100, 50}, Vector2d{300, 50}, Vector2d{300, 250}, Vector2d{100, 250}};
  gate.drawn = {true, true, true, true};
  gate.seen = {true, true, false, false};
  gate.side_px = 200.0, gate.distance = 4.0;
  return gate;
}

FoundCorners upper_pair(const sim::GateView& gate, double off) {
  FoundCorners found{.corners_px = gate.corners_px, .reported = {true, true, false, false}};
  found.corners_px[0].x() += off;
  found.corners_px[2] = {0, 0};  // not reported: of no account
  return found;
}

TEST(WideGates, AHitHasEveryReportedCornerWithinFivePerCentOfTheSide) {
  const sim::GateView gate = cut_below();
  EXPECT_TRUE(hits(upper_pair(gate, 9.9), gate));
  EXPECT_FALSE(hits(upper_pair(gate, 10.1), gate));
  sim::GateView far = gate;
  far.side_px = 20.0;
  EXPECT_TRUE(hits(upper_pair(far, 2.9), far));
  EXPECT_FALSE(hits(upper_pair(far, 3.1), far));
  FoundCorners one = upper_pair(gate, 0.0);
  one.reported[1] = false;
  EXPECT_FALSE(hits(one, gate)) << "one corner is no gate";
}

TEST(WideGates, WhatIsAboutAGateIsNotFalseFromWhicheverSide) {
  const sim::GateView gate = cut_below();
  EXPECT_TRUE(is_about(upper_pair(gate, 25.0), gate));
  EXPECT_FALSE(is_about(upper_pair(gate, 35.0), gate));
  FoundCorners whole{.corners_px = scaled(gate.corners_px, 0.8),
                     .reported = {true, true, true, true}};
  EXPECT_TRUE(is_about(whole, gate)) << "its opening";
  whole.corners_px = scaled(gate.corners_px, 0.5);
  EXPECT_FALSE(is_about(whole, gate));
  sim::GateView behind = gate;
  behind.drawn = {false, false, false, false};
  EXPECT_FALSE(is_about(upper_pair(behind, 0.0), behind));
}

TEST(WideGates, CountsGatesByCornersAndWhatIsNone) {
  world::World world;
  world.gates = {{.side = 2.0, .bar = 0.4}};
  const sim::GateView gate = cut_below();
  const simulated_race::Picture picture{.number = 7, .seed = 3, .gates = {gate}};
  FoundCorners wrong{.corners_px = scaled(gate.corners_px, 0.1),
                     .reported = {true, true, true, true}};
  WideLooks looks;
  looks.add(picture, world, {wrong, upper_pair(gate, 4.0)});
  looks.add(picture, world, {});
  ASSERT_EQ(looks.looks.size(), 2u);
  EXPECT_EQ(looks.pictures, 2u);
  EXPECT_TRUE(looks.looks[0].found);
  EXPECT_FALSE(looks.looks[1].found);
  EXPECT_EQ(looks.looks[0].outer, 2);
  EXPECT_DOUBLE_EQ(looks.looks[0].sides, 2.0);
  EXPECT_DOUBLE_EQ(looks.looks[0].scale, 196.0 / 200.0);
  EXPECT_EQ(looks.looks[0].errors_px, (std::vector<double>{4.0, 0.0}));
  EXPECT_EQ(looks.wrong.size(), 1u);
}

TEST(WideGates, IsRunOnTheSeedsThatAreNamed) {
  const Result result = wide_gates({.data = {}, .quick = true, .first_seed = 1201});
  EXPECT_EQ(result.json.at("first_seed"), 1201);
  EXPECT_EQ(result.json.at("pictures"), 12);
  EXPECT_GT(result.json.at("four_corners").at("gates"), 3);
  EXPECT_GT(result.json.at("four_corners").at("rate").get<double>(), 0.5);
}

}  // namespace
}  // namespace gatefly::experiments
