// SPDX-License-Identifier: Apache-2.0
// What counts as a gate passed. Every case here was somebody's false positive once.
#include "gatefly/sim/referee.hpp"

#include <functional>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {
namespace {

world::World one_gate() {
  world::World world;
  world.gates = {world::WorldGate{{5, 2, -1.5}, 0.5, 1.0, 0.05, {1, 0.5, 0}}};
  return world;
}

BodyState at(const world::World& world, const Eigen::Vector3d& p_G, double roll = 0.0,
             double yaw_G = 0.0) {
  const world::WorldGate& gate = world.gates[0];
  BodyState state;
  state.p_EB = gate.p_EG + rotation_z(gate.yaw_EG) * p_G;
  state.q_EB = q_EB_of({roll, 0.0, gate.yaw_EG + yaw_G});
  return state;
}

/// Flies `path` (gate frame, by time) for `seconds`, at 1 kHz; how many gates the referee counts.
int counted(const std::function<Eigen::Vector3d(double)>& path, double seconds, double roll = 0.0,
            double yaw_G = 0.0) {
  const world::World world = one_gate();
  Referee referee{world, world::VehicleTruth{}, 5};
  for (double t = 0.0; t < seconds; t += 0.001)
    (void)referee.update(at(world, path(t), roll, yaw_G), t);
  return referee.passed();
}

TEST(Referee, CountsAStraightPassThroughTheMiddleOnce) {
  EXPECT_EQ(counted([](double t) { return Eigen::Vector3d{-1 + 1.5 * t, 0, 0}; }, 2.0), 1);
}

TEST(Referee, SaysWhereAndWhenTheCentreCrossed) {
  const world::World world = one_gate();
  Referee referee{world, world::VehicleTruth{}, 1};
  std::optional<GatePass> pass;
  for (double t = 0.0; t < 2.0 && !pass; t += 0.001)
    pass = referee.update(at(world, {-1.5 + 1.5 * t, 0.1, -0.2}), t);
  ASSERT_TRUE(pass.has_value());
  EXPECT_NEAR(pass->time, 1.0, 1e-9);
  EXPECT_NEAR(pass->offset.x(), 0.1, 1e-9);
  EXPECT_NEAR(pass->offset.y(), -0.2, 1e-9);
  EXPECT_TRUE(referee.finished());
}

TEST(Referee, DoesNotCountAGraze) {
  // The right guard (0.165 m out) is outside the opening's edge (0.45 m) from y = 0.285 m on.
  EXPECT_EQ(counted([](double t) { return Eigen::Vector3d{-1 + 1.5 * t, 0.28, 0}; }, 2.0), 1);
  EXPECT_EQ(counted([](double t) { return Eigen::Vector3d{-1 + 1.5 * t, 0.29, 0}; }, 2.0), 0);
}

TEST(Referee, RollMakesTheDroneTaller) {
  const auto high = [](double t) { return Eigen::Vector3d{-1 + 1.5 * t, 0, -0.37}; };
  EXPECT_EQ(counted(high, 2.0, 0.0), 1);
  EXPECT_EQ(counted(high, 2.0, 0.6), 0);
}

TEST(Referee, DoesNotCountABackwardPass) {
  EXPECT_EQ(counted([](double t) { return Eigen::Vector3d{1 - 1.5 * t, 0, 0}; }, 2.0), 0);
}

TEST(Referee, DoesNotCountAPassBesideTheGate) {
  for (const double y : {-1.2, -0.6, 0.6, 1.2})
    EXPECT_EQ(counted([y](double t) { return Eigen::Vector3d{-1 + 1.5 * t, y, 0}; }, 2.0), 0) << y;
}

TEST(Referee, DoesNotCountAPassOverTheGate) {
  EXPECT_EQ(counted([](double t) { return Eigen::Vector3d{-1 + 1.5 * t, 0, -0.8}; }, 2.0), 0);
}

TEST(Referee, HoveringInThePlaneIsNotPassing) {
  EXPECT_EQ(counted(
                [](double t) {
                  return Eigen::Vector3d{0.05 * gatefly::sin(9 * t), 0, 0};
                },
                5.0),
            0);
}

TEST(Referee, HalfThroughAndBackIsNotPassing) {
  EXPECT_EQ(counted(
                [](double t) {
                  return Eigen::Vector3d{t < 1 ? -1 + 1.05 * t : 0.05 - (t - 1), 0, 0};
                },
                2.0),
            0);
}

TEST(Referee, HesitatingInThePlaneAndGoingOnCountsOnce) {
  EXPECT_EQ(counted(
                [](double t) {
                  return Eigen::Vector3d{-0.5 + 0.4 * t + 0.1 * gatefly::sin(12 * t), 0, 0};
                },
                3.0),
            1);
}

TEST(Referee, SeesADiagonalPassAtSixMetresPerSecond) {
  const double angle = 20 * kDegree;
  const auto diagonal = [angle](double offset) {
    return [=](double t) {
      const double along = -1.5 + 6.0 * t;
      return Eigen::Vector3d{along * gatefly::cos(angle), offset + along * gatefly::sin(angle), 0};
    };
  };
  EXPECT_EQ(counted(diagonal(0.0), 0.5, 0.0, angle), 1);
  EXPECT_EQ(counted(diagonal(0.30), 0.5, 0.0, angle), 0);
}

TEST(Referee, GatesCountInOrderOnly) {
  world::World world = one_gate();
  world.gates.push_back({{9, 2, -1.5}, 0.0, 1.0, 0.05, {1, 0.5, 0}});
  Referee referee{world, world::VehicleTruth{}, 1};
  BodyState state;
  for (double t = 0.0; t < 2.0; t += 0.001) {  // the second gate first
    state.p_EB = {8 + 1.5 * t, 2, -1.5};
    (void)referee.update(state, t);
  }
  EXPECT_EQ(referee.passed(), 0);
}

}  // namespace
}  // namespace gatefly::sim
