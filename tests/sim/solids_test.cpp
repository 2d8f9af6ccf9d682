// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/solids.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sim/collisions.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::sim {
namespace {

/// A room with a bit of everything.
World furnished() {
  World world;
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
  World world;
  world.gates = {{.p_EG = {2.0, 1.0, -1.5}}};
  std::vector<std::string> names;
  for (const Solid& solid : solids_of(world)) names.push_back(solid.name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"north wall", "south wall", "east wall", "west wall",
                                      "ceiling", "gate 1 left bar", "gate 1 right bar",
                                      "gate 1 upper bar", "gate 1 lower bar", "gate 1 pole"}));
}

TEST(SolidSight, ARayEndsWhereTheFirstSolidBegins) {
  const World world = furnished();
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
  World world;
  world.obstacles = {{{-1.0, 0.0}, {0.5, 5.0}, 0.0, 0.0, 2.0, false}};
  const SolidSight sight{world};
  EXPECT_FALSE(sight.occluded({0, 0, -1}, {5, 0, -1}));
  EXPECT_TRUE(sight.occluded({0, 0, -1}, {-5, 0, -1}));
}

// Points of the body inside a solid: it must be named. Body far from all of them: it must not be.
TEST(Collisions, TheBodyTouchesWhatItsPointsAreIn) {
  const World world = furnished();
  const auto solids = solids_of(world);
  const VehicleTruth vehicle;
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
