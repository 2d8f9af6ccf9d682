// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/solids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sim/collisions.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::sim {
namespace {

/// A room with a bit of everything.
world::World furnished() {
  world::World world;
  world.gates = {{.p_EG = {2.0, 1.0, -1.5}, .yaw_EG = 0.6},
                 {.p_EG = {-3.0, 2.0, -1.8}, .yaw_EG = -2.0}};
  world.obstacles = {{{1.0, -3.0}, {1.5, 0.6}, 0.5, 0.0, 1.9, false},
                     {{-2.0, -2.0}, {0.4, 0.4}, 0.0, 0.0, 2.5, true},
                     {{0.0, 4.0}, {2.0, 1.0}, 1.0, 1.0, 1.3, false}};
  world.decoys = {{{{4.0, -4.0}, {0.5, 0.1}, 0.2, 0.3, 1.6, false}}};
  return world;
}

bool inside(const Solid& solid, const Eigen::Vector3d& p_E) {
  const Eigen::Vector3d p = rotation_z(-solid.heading) * (p_E - solid.center_E),
                        half = 0.5 * solid.size;
  if (std::abs(p.z()) > half.z()) return false;
  return solid.pole ? p.head<2>().norm() <= half.x()
                    : std::abs(p.x()) <= half.x() && std::abs(p.y()) <= half.y();
}

bool filled(const std::vector<Solid>& solids, const Eigen::Vector3d& p_E) {
  return p_E.z() >= 0.0 ||
         std::any_of(solids.begin(), solids.end(), [&](const Solid& s) { return inside(s, p_E); });
}

TEST(Solids, EveryGateHasFourBarsAndAPoleByName) {
  world::World world;
  world.gates = {{.p_EG = {2.0, 1.0, -1.5}}};
  std::vector<std::string> names;
  for (const Solid& solid : solids_of(world)) names.push_back(solid.name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"north wall", "south wall", "east wall", "west wall",
                                      "ceiling", "gate 1 left bar", "gate 1 right bar",
                                      "gate 1 upper bar", "gate 1 lower bar", "gate 1 pole"}));
}

/// Two gates of the same size, one above the other, so much room between their frames.
world::World stacked(double between, Stream& draw) {
  world::World world;
  world.room_size = {20, 20, 12};
  const auto off = [&] { return 0.25 * draw.uniform(-1.0, 1.0); };  // 2.5 sigma of level race
  const double side = draw.uniform(1.0, 2.7), bar = draw.uniform(0.05, 0.22) * side;
  const double yaw = draw.uniform(-3.0, 3.0);
  const double low = draw.uniform(0.5 * side, 2.0);
  world.gates = {{.p_EG = {off(), off(), -low}, .yaw_EG = yaw, .side = side, .bar = bar},
                 {.p_EG = {off(), off(), -low - side - between},
                  .yaw_EG = yaw + 3.1,
                  .side = side,
                  .bar = bar}};
  if (draw.uniform() < 0.5) std::swap(world.gates[0], world.gates[1]);
  return world;
}

// The support of the upper one of stacked gates does not stand in the lower one's opening.
TEST(Solids, NothingStandsInAnOpeningOfStackedGates) {
  Stream draw{11, "stacked gates"};
  for (int i = 0; i < 60; ++i) {
    const world::World world = stacked(0.2 + draw.uniform(), draw);
    const SolidSight sight{world};
    for (const world::WorldGate& gate : world.gates) {
      const Eigen::Matrix3d R_EG = rotation_z(gate.yaw_EG);
      const double in = 0.5 * gate.side - gate.bar - 1e-3;
      for (int k = 0; k < 200; ++k) {
        const Eigen::Vector3d before_G{-1.0, draw.uniform(-in, in), draw.uniform(-in, in)};
        EXPECT_FALSE(sight.occluded(gate.p_EG + R_EG * before_G,
                                    gate.p_EG + R_EG * (before_G + Eigen::Vector3d{2.0, 0, 0})))
            << i << ": " << before_G.transpose();
      }
    }
  }
}

TEST(Solids, AnUpperGateIsCarriedByTheFrameBeneathItAndOthersByTheFloor) {
  Stream draw{12, "stacked gates"};
  for (const double between : {0.0, 0.5}) {
    world::World world = stacked(between, draw);
    const auto poles = [&] {
      std::vector<std::array<double, 2>> heights;
      for (const Solid& solid : solids_of(world))
        if (solid.name.ends_with(" pole"))
          heights.push_back({-solid.center_E.z() - 0.5 * solid.size.z(),
                             -solid.center_E.z() + 0.5 * solid.size.z()});
      std::sort(heights.begin(), heights.end());
      return heights;
    };
    std::sort(world.gates.begin(), world.gates.end(),
              [](const auto& a, const auto& b) { return a.p_EG.z() > b.p_EG.z(); });
    world::WorldGate &lower = world.gates[0], &upper = world.gates[1];
    lower.p_EG.z() = -0.5 * lower.side - 0.3;
    upper.p_EG.z() = lower.p_EG.z() - lower.side - between;
    const double lower_top = -lower.p_EG.z() + 0.5 * lower.side;
    const auto both = poles();
    ASSERT_EQ(both.size(), between > 0.0 ? 2u : 1u);
    EXPECT_NEAR(both[0][0], 0.0, 1e-12);
    if (between > 0.0) {
      EXPECT_NEAR(both[1][0], lower_top, 1e-9);
      EXPECT_NEAR(both[1][1], lower_top + between, 1e-9);
    }
    lower.missing = true;  // nothing is left to carry it
    ASSERT_EQ(poles().size(), 1u);
    EXPECT_NEAR(poles()[0][0], 0.0, 1e-12);
    lower.missing = false;
    upper.p_EG.head<2>() += Eigen::Vector2d{2.0, 2.0};  // beside it
    for (const auto& pole : poles()) EXPECT_NEAR(pole[0], 0.0, 1e-12);
  }
}

TEST(SolidSight, ARayEndsWhereTheFirstSolidBegins) {
  const world::World world = furnished();
  const auto solids = solids_of(world);
  const SolidSight sight{world};
  Stream draw{7, "rays"};
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d from{draw.uniform(-6.5, 6.5), draw.uniform(-7.5, 7.5),
                               draw.uniform(-3.1, -0.1)};
    if (filled(solids, from)) continue;
    const Eigen::Vector3d along =
        Eigen::Vector3d{draw.normal(), draw.normal(), draw.normal()}.normalized();
    const double range = sight.range(from, along, 30.0);
    ASSERT_LT(range, 30.0);  // the room is closed
    EXPECT_TRUE(filled(solids, from + (range + 1e-6) * along)) << i;
    for (double t = 0.0; t < range - 0.01; t += 0.01)
      ASSERT_FALSE(filled(solids, from + t * along)) << i << ' ' << t;
    EXPECT_EQ(sight.range(from, along, 0.5 * range), 0.5 * range);
    EXPECT_TRUE(sight.occluded(from, from + 1.1 * range * along));
    EXPECT_FALSE(sight.occluded(from, from + 0.99 * range * along));
  }
}

TEST(SolidSight, WhatIsBehindTheEyeHidesNothing) {
  world::World world;
  world.obstacles = {{{-1.0, 0.0}, {0.5, 5.0}, 0.0, 0.0, 2.0, false}};
  const SolidSight sight{world};
  EXPECT_FALSE(sight.occluded({0, 0, -1}, {5, 0, -1}));
  EXPECT_TRUE(sight.occluded({0, 0, -1}, {-5, 0, -1}));
}

// Points of the body inside a solid: it must be named. Body far from all of them: it must not be.
TEST(Collisions, TheBodyTouchesWhatItsPointsAreIn) {
  const world::World world = furnished();
  const auto solids = solids_of(world);
  const world::VehicleTruth vehicle;
  const Collisions collisions{world, vehicle};
  Stream draw{8, "bodies"};
  int touching = 0, near_miss = 0;
  for (int i = 0; i < 3000; ++i) {
    BodyState state;  // near one of them
    const Solid& solid =
        solids[static_cast<std::size_t>(draw.uniform(5.0, static_cast<double>(solids.size())))];
    const Eigen::Vector3d part{draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5),
                               draw.uniform(-0.5, 0.5)};
    state.p_EB = solid.center_E + rotation_z(solid.heading) * solid.size.cwiseProduct(part) +
                 0.25 * Eigen::Vector3d{draw.normal(), draw.normal(), draw.normal()};
    if (state.p_EB.z() > -0.3) continue;
    state.q_EB =
        Eigen::Vector4d{draw.normal(), draw.normal(), draw.normal(), draw.normal()}.normalized();
    const Eigen::Matrix3d R_EB = R_EB_of(state.q_EB);
    // A grid through the body's box: the truth up to its spacing.
    bool inside_one = false;
    constexpr int kGrid = 12;
    for (int x = 0; x <= kGrid; ++x)
      for (int y = 0; y <= kGrid; ++y)
        for (int z = 0; z <= 4; ++z) {
          const Eigen::Vector3d at{x / double{kGrid} - 0.5, y / double{kGrid} - 0.5, z / 4.0 - 0.5};
          const Eigen::Vector3d p_E = state.p_EB + R_EB * vehicle.size.cwiseProduct(at);
          inside_one = inside_one || std::any_of(solids.begin(), solids.end(),
                                                 [&](const Solid& s) { return inside(s, p_E); });
        }
    const bool touched = collisions.touched(state) != nullptr;
    EXPECT_TRUE(touched || !inside_one) << i;
    touching += inside_one, near_miss += touched && !inside_one;
  }
  EXPECT_GT(touching, 1000);
  EXPECT_LT(touching + near_miss, 2500);
  EXPECT_LT(near_miss, touching / 10);  // corners and thin bars that slip through the grid
}

}  // namespace
}  // namespace gatefly::sim
