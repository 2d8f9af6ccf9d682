// SPDX-License-Identifier: Apache-2.0
// Flights through gates that are not the next one.
#include "gatefly/sim/stray_passes.hpp"

#include <numbers>

#include <gtest/gtest.h>

namespace gatefly::sim {
namespace {

constexpr double kNorth = 0.0, kEast = 0.5 * std::numbers::pi;

/// Two gates of the map, at 5 m and 10 m north, and a false one 5 m east, that is flown through
/// eastwards; openings of 0.9 m.
world::World two_gates_and_a_false_one() {
  const auto gate = [](const Eigen::Vector3d& p_EG, double yaw_EG) {
    return world::WorldGate{p_EG, yaw_EG, 1.0, 0.05, {1, 0.5, 0}};
  };
  world::World world;
  world.gates = {gate({5, 0, -1.5}, kNorth), gate({10, 0, -1.5}, kNorth)};
  world.false_gates = {gate({0, 5, -1.5}, kEast)};
  return world;
}

StrayPasses flown_straight(const Eigen::Vector3d& from_E, const Eigen::Vector3d& to_E, int next) {
  StrayPasses passes{two_gates_and_a_false_one()};
  for (int i = 0; i <= 1000; ++i) passes.update(from_E + 1e-3 * i * (to_E - from_E), next);
  return passes;
}

TEST(StrayPasses, CountAFalseGateFromEitherSide) {
  const Eigen::Vector3d before{0.3, 4, -1.5}, behind{0.3, 6, -1.3};
  EXPECT_EQ(flown_straight(before, behind, 0).through_false_gates(), 1);
  EXPECT_EQ(flown_straight(behind, before, 0).through_false_gates(), 1);
}

TEST(StrayPasses, DoNotCountWhatGoesBesideOrOverAFalseGate) {
  EXPECT_EQ(flown_straight({0.46, 4, -1.5}, {0.46, 6, -1.5}, 0).through_false_gates(), 0);
  EXPECT_EQ(flown_straight({0, 4, -1.96}, {0, 6, -1.96}, 0).through_false_gates(), 0);
}

TEST(StrayPasses, DoNotCountTheNextGate) {
  EXPECT_EQ(flown_straight({4, 0, -1.5}, {6, 0, -1.5}, 0).through_other_gates(), 0);
}

TEST(StrayPasses, CountAGateOutOfTurnForwardsOnly) {
  EXPECT_EQ(flown_straight({9, 0, -1.5}, {11, 0, -1.5}, 0).through_other_gates(), 1);
  EXPECT_EQ(flown_straight({11, 0, -1.5}, {9, 0, -1.5}, 0).through_other_gates(), 0);
}

TEST(StrayPasses, CountOneOutOfTurnForEachGateThatIsNext) {
  StrayPasses passes{two_gates_and_a_false_one()};
  const auto through = [&](double north, int next) {
    passes.update({north - 1, 0, -1.5}, next);
    passes.update({north + 1, 0, -1.5}, next);
    passes.update({north + 1, 3, -1.5}, next);
    passes.update({north - 1, 3, -1.5}, next);
  };
  through(10, 0), through(10, 0);
  EXPECT_EQ(passes.through_other_gates(), 1) << "gate 1 was missed";
  through(5, 0), through(5, 1);
  EXPECT_EQ(passes.through_other_gates(), 2) << "gate 2 was";
}

TEST(StrayPasses, DoNotCountAGateThatIsNotThere) {
  world::World world = two_gates_and_a_false_one();
  world.gates[1].missing = true;
  StrayPasses passes{world};
  passes.update({9, 0, -1.5}, 0), passes.update({11, 0, -1.5}, 0);
  EXPECT_EQ(passes.through_other_gates(), 0);
}

}  // namespace
}  // namespace gatefly::sim
