// SPDX-License-Identifier: Apache-2.0
// How the rooms are lit: baker, light map, shading.
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/light_map.hpp"
#include "gatefly/sim/shading.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::sim {
namespace {

constexpr int kCeiling = 0, kWindow = 1;  // light groups

/// A lamp of 10 x 10 cm, 2 m above the origin, shining down; radiance 3.
struct Lamp {
  Lamp() {
    SceneBuilder builder{scene};
    builder.rectangle({-0.05, -0.05, -2.0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 1},
                      builder.light({3, 3, 3}, kWindow));
  }
  [[nodiscard]] NodeLight at(const Eigen::Vector3f& p, const Eigen::Vector3f& n) const {
    const RayScene rays{{&scene.fixed}};
    return Baker{scene, rays}.direct({p, n}, NodeRandom{1});
  }
  Scene scene;
};

const Eigen::Vector3f kUp{0, 0, -1};

// E = L A cos(θ) cos(θ') / r², both cosines h / r.
TEST(Baker, ALampLightsWithTheCosinesAndTheInverseSquare) {
  const Lamp lamp;
  for (const float aside : {0.0f, 0.5f, 1.5f}) {
    const NodeLight light = lamp.at({aside, 0, 0}, kUp);
    const double r2 = 4.0 + static_cast<double>(aside * aside),
                 expected = 3.0 * 0.01 * 4.0 / (r2 * r2);
    for (std::size_t c = 0; c < 3; ++c) {
      // The one ray goes to anywhere on the lamp.
      EXPECT_NEAR(light[3 * kWindow + c], expected, 0.06 * expected) << aside;
      EXPECT_EQ(light[3 * kCeiling + c], 0.0f) << "the other group's";
    }
  }
}

TEST(Baker, ALampLightsNothingBehindItNorWhatFacesAway) {
  const Lamp lamp;
  EXPECT_GT(lamp.at({0, 0, -1}, kUp)[3 * kWindow], 0.0f);
  EXPECT_EQ(lamp.at({0, 0, -1}, -kUp)[3 * kWindow], 0.0f);
  EXPECT_EQ(lamp.at({0, 0, -3}, -kUp)[3 * kWindow], 0.0f);
}

TEST(Baker, ABoxThrowsAShadow) {
  Lamp lamp;
  SceneBuilder builder{lamp.scene};
  builder.box({}, {-0.3, -0.3, 0.9}, {0.3, 0.3, 1.1}, builder.matt({}));
  EXPECT_EQ(lamp.at({0, 0, 0}, kUp)[3 * kWindow], 0.0f);
  EXPECT_EQ(lamp.at({0.3f, 0, 0}, kUp)[3 * kWindow], 0.0f);
  EXPECT_GT(lamp.at({1.0f, 0, 0}, kUp)[3 * kWindow], 0.0f);
}

// With irradiance E on every wall, what comes back is albedo times E (over π, which goes into
// the radiance of all of them): nothing is lost or won by the directions of the rays.
TEST(Baker, InAFurnaceABounceGivesTheAlbedo) {
  Scene scene;
  SceneBuilder builder{scene};
  const int grey = builder.matt({0.5f, 0.4f, 0.2f}),
            mixed = builder.matt({0.5f, 0.4f, 0.2f}, Pattern::kGrain, {0.7f, 0.6f, 0.8f}, 3.0);
  for (const int material : {grey, mixed}) {
    scene.fixed.clear();
    for (const double side : {-1.0, 1.0}) {
      builder.rectangle({-1, -1, side}, {2, 0, 0}, {0, 2, 0}, {0, 0, -side}, material);
      builder.rectangle({-1, side, -1}, {2, 0, 0}, {0, 0, 2}, {0, -side, 0}, material);
      builder.rectangle({side, -1, -1}, {0, 2, 0}, {0, 0, 2}, {-side, 0, 0}, material);
    }
    NodeLight even;
    even.fill(2.0f);
    const std::vector<NodeLight> from(static_cast<std::size_t>(Scene::nodes(scene.fixed)), even);
    const RayScene rays{{&scene.fixed}};
    const NodeLight light =
        Baker{scene, rays}.bounced({{0.3f, 0.2f, 0.5f}, {0.6f, 0, 0.8f}}, NodeRandom{7}, from);
    const Color& one = scene.materials[static_cast<std::size_t>(material)].albedo;
    const Color& two = scene.materials[static_cast<std::size_t>(material)].second;
    for (std::size_t c = 0; c < light.size(); ++c)
      EXPECT_NEAR(light[c], one[c % 3] + two[c % 3], 1e-5f);
  }
}

/// The smallest hall that has lamps, a window and clutter.
Scene small_hall() {
  world::World world;
  world.room_size = {4, 4, 3.0};
  world.gates = {{.p_EG = {0, 0, -1.5}}};
  return make_scene(world);
}

TEST(LightMap, DoesNotDependOnTheNumberOfThreads) {
  const Scene scene = small_hall();
  const RayScene rays{{&scene.fixed}};
  const auto alone = fixed_light(scene, rays, {}, 1), three = fixed_light(scene, rays, {}, 3);
  ASSERT_EQ(alone.nodes.size(), static_cast<std::size_t>(Scene::nodes(scene.fixed)));
  EXPECT_EQ(alone.nodes, three.nodes);
  EXPECT_GT(alone.bake_seconds, 0.0);
}

TEST(LightMap, ComesBackFromItsCacheWhichMayBeDamagedOrClosed) {
  const test::TempFolder folder;
  const Scene scene = small_hall();
  const RayScene rays{{&scene.fixed}};
  const auto baked = fixed_light(scene, rays, folder.path() / "light", 2),
             cached = fixed_light(scene, rays, folder.path() / "light", 2);
  EXPECT_GT(baked.bake_seconds, 0.0);
  EXPECT_EQ(cached.bake_seconds, 0.0);
  EXPECT_EQ(cached.nodes, baked.nodes);

  for (const auto& entry : std::filesystem::directory_iterator{folder.path() / "light"}) {
    std::fstream file{entry.path(), std::ios::in | std::ios::out | std::ios::binary};
    file.seekp(1000);
    file.put('\x55');
  }
  const auto again = fixed_light(scene, rays, folder.path() / "light", 2);
  EXPECT_GT(again.bake_seconds, 0.0);
  EXPECT_EQ(again.nodes, baked.nodes);

  const auto closed = fixed_light(scene, rays, folder.file("a file", "") / "light", 2);
  EXPECT_EQ(closed.nodes, baked.nodes);
}

TEST(LightMap, WhatItsCallerThrowsMeanwhileEndsTheBakeAndKeepsNothing) {
  struct Enough {};
  world::World world;
  world.room_size = {120, 120, 6.0};  // minutes
  const Scene scene = make_scene(world);
  const RayScene rays{{&scene.fixed}};
  const test::TempFolder folder;
  for (const int threads : {1, 3}) {
    int calls = 0;
    const auto cpu = std::clock();
    const auto stop = [&] {
      if (++calls == 3) throw Enough{};
    };
    EXPECT_THROW((void)fixed_light(scene, rays, folder.path(), threads, stop), Enough);
    EXPECT_EQ(calls, 3);
    EXPECT_LT(std::clock() - cpu, 2 * CLOCKS_PER_SEC) << "of all threads, after 0.1 s";
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(LightMap, MovedThingsAreLitByTheLampsToo) {
  const Scene scene = small_hall();
  const RayScene rays{{&scene.fixed}};
  const LightMap fixed = fixed_light(scene, rays, {}, 2), moved = moved_light(scene, rays, fixed);
  ASSERT_EQ(moved.nodes.size(), static_cast<std::size_t>(Scene::nodes(scene.moved)));
  for (const Rectangle& r : scene.moved) {
    const NodeLight& light = moved.nodes[static_cast<std::size_t>(r.first_node)];
    EXPECT_GT(light[3 * kCeiling], 0.0f);
    // The ceiling's light comes more from above than from below.
    if (r.normal.z() > -0.9f) continue;
    for (const Rectangle& other : scene.moved) {
      if (other.normal.z() < 0.9f) continue;
      EXPECT_GT(light[3 * kCeiling],
                moved.nodes[static_cast<std::size_t>(other.first_node)][3 * kCeiling]);
    }
  }
}

/// One square metre of one material, its nodes' light given.
struct Surface {
  explicit Surface(const Material& material) {
    SceneBuilder builder{scene};
    builder.rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, builder.material(material));
    map.nodes.resize(static_cast<std::size_t>(Scene::nodes(scene.fixed)));
  }
  [[nodiscard]] Float4 radiance(float u, float v, const world::LightConditions& light = {}) const {
    return Shader{scene, map, {}, light}.radiance(0, u, v);
  }
  [[nodiscard]] NodeLight& node(int i, int j) {
    const Rectangle& r = scene.fixed[0];
    return map.nodes[static_cast<std::size_t>(j * (r.cells_u + 1) + i)];
  }
  Scene scene;
  LightMap map;
};

TEST(Shader, RadianceIsAlbedoTimesIrradianceOverPi) {
  Surface surface{{.albedo = {0.2f, 0.4f, 0.8f}}};
  for (NodeLight& node : surface.map.nodes) node = {1, 1, 1, 2, 2, 2, 0, 0, 0};
  const Float4 rgb = surface.radiance(0.3f, 0.6f);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], 0.2 * (1 << c) * 3.0 / kPi, 1e-6);
}

TEST(Shader, EachGroupsGainMultipliesItsOwnLightAndLamps) {
  Surface surface{{.albedo = {0.5f, 0.5f, 0.5f}, .emission = {4, 4, 4}, .group = kWindow}};
  for (NodeLight& node : surface.map.nodes) node = {1, 1, 1, 2, 2, 2, 8, 8, 8};
  world::LightConditions light;
  light.group_gain = {0.5, 3.0, 0.0};
  EXPECT_NEAR(surface.radiance(0.5f, 0.5f, light)[0], 4 * 3.0 + 0.5 * (0.5 * 1 + 3.0 * 2) / kPi,
              1e-5);
}

TEST(Shader, LightRunsEvenlyFromNodeToNode) {
  Surface surface{{.albedo = {1, 1, 1}, .second = {1, 1, 1}}};
  const Rectangle r = surface.scene.fixed[0];
  ASSERT_GT(r.cells_u, 1);
  for (int j = 0; j <= r.cells_v; ++j)
    for (int i = 0; i <= r.cells_u; ++i)
      surface.node(i, j)[0] =
          static_cast<float>(kPi * (1.0 + 2.0 * i / r.cells_u + 0.5 * j / r.cells_v));
  for (const float u : {0.0f, 0.1f, 0.5f, 0.97f, 1.0f})
    for (const float v : {0.0f, 0.3f, 1.0f})
      EXPECT_NEAR(surface.radiance(u, v)[0], 1.0f + 2.0f * u + 0.5f * v, 1e-5f) << u << ' ' << v;
}

TEST(Shader, PatternsMixTheTwoAlbedosAndNothingElse) {
  for (const Pattern pattern :
       {Pattern::kGrain, Pattern::kTiles, Pattern::kPlanks, Pattern::kBlocks}) {
    Surface surface{{.albedo = {0.2f, 0.8f, 0.5f},
                     .second = {0.6f, 0.4f, 0.5f},
                     .pattern = pattern,
                     .scale = 20.0f}};
    for (NodeLight& node : surface.map.nodes) node.fill(static_cast<float>(kPi / 3));
    const Shader shader{surface.scene, surface.map, {}, {}};
    float least = 1.0f, most = 0.0f;
    for (float u = 0.0f; u < 1.0f; u += 0.017f)
      for (float v = 0.0f; v < 1.0f; v += 0.017f) {
        const Float4 rgb = shader.radiance(0, u, v);
        const float share = (rgb[0] - 0.2f) / 0.4f;
        least = std::min(least, share), most = std::max(most, share);
        EXPECT_NEAR(rgb[1], 0.8f - 0.4f * share, 1e-5f);
        EXPECT_NEAR(rgb[2], 0.5f, 1e-5f);
      }
    EXPECT_GE(least, -1e-5f);
    EXPECT_LE(most, 1.0f + 1e-5f);
    EXPECT_GT(most - least, 0.5f) << "a pattern shows";
  }
}

}  // namespace
}  // namespace gatefly::sim
