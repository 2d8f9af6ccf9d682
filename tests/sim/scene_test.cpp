// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::sim {
namespace {

/// A room off the origin with a box, a show-case, a pole, a hanging beam, two gates and a decoy.
world::World furnished(const std::string& look) {
  world::World world;
  world.look = look;
  world.room_size = {9, 11, 3.2};
  world.room_center = {2, -1};
  world.gates = {{.p_EG = {2.0, 1.0, -1.5}, .yaw_EG = 0.6},
                 {.p_EG = {0.0, -3.0, -1.8}, .yaw_EG = -2.0}};
  world.obstacles = {{{3.0, -3.0}, {2.5, 0.8}, 0.5, 0.0, 1.9, false},
                     {{1.0, 3.0}, {1.2, 0.9}, -0.3, 0.0, 0.9, false},
                     {{4.0, 2.0}, {0.4, 0.4}, 0.0, 0.0, 2.5, true},
                     {{0.0, 0.0}, {2.0, 0.3}, 1.0, 2.0, 2.3, false}};
  world.decoys = {{{{4.0, -4.0}, {0.3, 0.3}, 0.2, 0.0, 1.6, false}}};
  return world;
}

std::array<Eigen::Vector3d, 4> corners(const Rectangle& r) {
  return {r.corner.cast<double>(), (r.corner + r.edge_u).cast<double>(),
          (r.corner + r.edge_v).cast<double>(), (r.corner + r.edge_u + r.edge_v).cast<double>()};
}

/// Whether p stands inside an obstacle's footprint.
bool in_footprint(const world::WorldBox& box, const Eigen::Vector3d& p_E, double margin) {
  const Eigen::Vector2d p =
      (rotation_z(-box.heading) * (p_E - Eigen::Vector3d{box.center.x(), box.center.y(), 0.0}))
          .head<2>();
  // A pole is drawn as an octagon around its circle.
  if (box.pole) return p.norm() <= 0.5 * box.size.x() / std::cos(std::acos(-1.0) / 8) + margin;
  return std::abs(p.x()) <= 0.5 * box.size.x() + margin &&
         std::abs(p.y()) <= 0.5 * box.size.y() + margin;
}

class Looks : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scene, Looks,
                         testing::Values("hall", "showroom", "dark_hall", "exhibition"));

TEST_P(Looks, RectanglesAreFlatUprightAndCountTheirNodes) {
  const Scene scene = make_scene(furnished(GetParam()));
  for (const auto* list : {&scene.fixed, &scene.moved, &scene.solid}) {
    ASSERT_FALSE(list->empty());
    int node = 0;
    for (const Rectangle& r : *list) {
      EXPECT_NEAR(r.normal.norm(), 1.0f, 1e-5f);
      EXPECT_NEAR(r.normal.dot(r.edge_u), 0.0f, 1e-5f);
      EXPECT_NEAR(r.normal.dot(r.edge_v), 0.0f, 1e-5f);
      EXPECT_GT(r.edge_u.cross(r.edge_v).dot(r.normal), 0.0f);
      EXPECT_NEAR(r.length.x(), r.edge_u.norm(), 1e-5f);
      EXPECT_NEAR(r.length.y(), r.edge_v.norm(), 1e-5f);
      EXPECT_EQ(r.first_node, node);
      node += r.nodes();
      ASSERT_LT(static_cast<std::size_t>(r.material), scene.materials.size());
    }
    EXPECT_EQ(Scene::nodes(*list), node);
  }
}

TEST_P(Looks, ClutterStaysAtTheWallsOnTheFloorUpHighOrInsideObstacles) {
  const world::World world = furnished(GetParam());
  for (const Rectangle& r : make_scene(world).fixed) {
    const auto all = corners(r);
    // Corner by corner would let a thing hang across the room.
    const auto each = [&](auto&& holds) { return std::all_of(all.begin(), all.end(), holds); };
    const auto wall = [&](int axis, double side) {
      return each([&](const Eigen::Vector3d& p) {
        return 0.5 * world.room_size[axis] - side * (p[axis] - world.room_center[axis]) < 0.4001;
      });
    };
    const bool at_wall = wall(0, 1) || wall(0, -1) || wall(1, 1) || wall(1, -1);
    const bool on_floor = each([](const Eigen::Vector3d& p) { return -p.z() < 0.01; });
    const bool high = each([](const Eigen::Vector3d& p) { return -p.z() > 2.599; });
    const bool in_obstacle = std::any_of(
        world.obstacles.begin(), world.obstacles.end(), [&](const world::WorldBox& box) {
          return each([&](const Eigen::Vector3d& p) { return in_footprint(box, p, 0.001); });
        });
    EXPECT_TRUE(at_wall || on_floor || high || in_obstacle)
        << all[0].transpose() << " to " << all[3].transpose();
  }
}

TEST_P(Looks, WhatASeedMovesLeavesTheRoomAndItsLightMapAlone) {
  const world::World one = furnished(GetParam());
  world::World other = one;
  other.gates[0].p_EG.x() += 0.3, other.gates[0].color = {0, 0, 1};
  other.decoys.clear();
  EXPECT_EQ(make_scene(one).fixed_hash(), make_scene(other).fixed_hash());
  EXPECT_NE(make_scene(one).moved.size(), make_scene(other).moved.size());
  other.obstacles[0].top += 0.01;
  EXPECT_NE(make_scene(one).fixed_hash(), make_scene(other).fixed_hash()) << "an obstacle does not";
}

TEST(Scene, AGatesBarsEncloseItsOpeningInItsColour) {
  world::World world;
  world.gates = {{.p_EG = {2.0, 1.0, -1.5}, .yaw_EG = 0.6, .side = 1.2, .color = {0.1, 0.2, 0.7}}};
  world.paint = {.width = 1.0, .blue = 1.0, .wear = 0.0};
  const Scene scene = make_scene(world);
  const world::WorldGate& gate = world.gates[0];
  Eigen::Vector3d low{9, 9, 9}, high = -low;
  int bars = 0;
  for (const Rectangle& r : scene.moved) {
    const Color& albedo = scene.materials[static_cast<std::size_t>(r.material)].albedo;
    if (albedo != Color{0.1f, 0.2f, 0.7f}) continue;  // pole and foot
    ++bars;
    for (const Eigen::Vector3d& p_E : corners(r)) {
      const Eigen::Vector3d p_G = rotation_z(-gate.yaw_EG) * (p_E - gate.p_EG);
      low = low.cwiseMin(p_G), high = high.cwiseMax(p_G);
      EXPECT_GE(std::max(std::abs(p_G.y()), std::abs(p_G.z())), 0.6 - gate.bar - 1e-5);
    }
  }
  EXPECT_EQ(bars, 4 * 6);
  const Eigen::Vector3d half{0.5 * gate.bar, 0.6, 0.6};
  EXPECT_LT((high - half).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((low + half).cwiseAbs().maxCoeff(), 1e-5);
}

// The picture as the collisions: the upper one of two stacked gates has no pole in the lower opening,
// and no foot on the floor there.
TEST(Scene, NoPoleIsSeenInAnOpeningOfStackedGates) {
  world::World world;
  world.room_size = {20, 20, 8};
  for (const double height : {1.5, 4.6})
    world.gates.push_back(
        {.p_EG = {0.1 * height, 0.1, -height}, .yaw_EG = 0.6, .side = 2.7, .bar = 0.6});
  const auto seen_in_lower = [&] {
    const world::WorldGate& gate = world.gates[0];
    const double in = 0.5 * gate.side - gate.bar;
    const Scene scene = make_scene(world);
    int count = 0;
    for (const auto* list : {&scene.moved, &scene.solid})
      for (const Rectangle& r : *list) {
        const Eigen::Vector3d middle =
            (r.corner + 0.5f * (r.edge_u + r.edge_v)).cast<double>() - gate.p_EG;
        const Eigen::Vector3d p_G = rotation_z(-gate.yaw_EG) * middle;
        count += std::abs(p_G.x()) < 1.0 && std::abs(p_G.y()) < in && p_G.z() > -in;
      }
    return count;
  };
  const int with_both = seen_in_lower();
  world.gates.pop_back();
  EXPECT_EQ(with_both, seen_in_lower());
}

TEST(SceneBuilder, ABoxShowsItsFacesOutwardsAndNoneOnTheFloor) {
  Scene scene;
  SceneBuilder builder{scene};
  builder.box({.origin = {1, 2}, .heading = 0.7}, {-1, -0.5, 0}, {1, 0.5, 2}, builder.matt({}));
  EXPECT_EQ(scene.fixed.size(), 5u);
  builder.box({}, {-1, -1, 0.5}, {1, 1, 1}, 0);
  ASSERT_EQ(scene.fixed.size(), 11u);
  for (std::size_t i = 0; i < scene.fixed.size(); ++i) {
    const Rectangle& r = scene.fixed[i];
    const Eigen::Vector3f centre =
        i < 5 ? Eigen::Vector3f{1, 2, -1} : Eigen::Vector3f{0, 0, -0.75f};
    EXPECT_GT(r.normal.dot(r.corner + 0.5f * (r.edge_u + r.edge_v) - centre), 0.0f) << i;
  }
}

}  // namespace
}  // namespace gatefly::sim
