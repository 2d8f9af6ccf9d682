// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/association.hpp"

#include <array>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;

// Three gates; a drone that hovers at (0, 0, -1.5) and looks north.
struct Scene {
  Scene() : filter{setup()} {
    rig.R_BC = camera_mount(0.0);
    filter.start({.p_EB = {0, 0, -1.5}, .rest_accel_B = {}}, 0.0);
    for (int i = 1; i <= 100; ++i) filter.predict({Vector3d::Zero(), {0, 0, -9.81}}, kDt, i * kDt);
  }
  static eskf::Setup setup() {
    eskf::Setup setup;
    setup.map = {{{5, 0, -1.5}, 0.0, {}}, {{8, 2.5, -1.5}, kPi, {}}, {{-5, 0, -1.5}, 0.0, {}}};
    setup.R_BC = camera_mount(0.0).matrix;
    return setup;
  }

  /// The corners of a gate at `p_EG`, looked at from the side that faces south.
  [[nodiscard]] Quad corners(const Vector3d& p_EG) const {
    Quad corners;
    const auto at = gate_corners_G(1.0);
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector3d p_B = p_EG + at[i] - Vector3d{0, 0, -1.5};
      corners[i] = rig.lens.project(rig.R_BC.matrix.transpose() * p_B).value();
    }
    return corners;
  }
  [[nodiscard]] std::optional<eskf::GateSight> sight(const Vector3d& p_EG) const {
    return sight_of(corners(p_EG), {rig, timing, 100 * kDt + 0.02, {315.0, 160.0}});
  }

  static constexpr double kDt = 1.0 / 512;
  CameraRig rig;
  CameraTiming timing{.latency = 0.044, .readout = 0.0};
  eskf::ErrorStateFilter filter;
};

TEST(Association, TellsWhichGateAndWhichFaceOfIt) {
  const Scene scene;
  const auto ahead = associate(scene.filter, *scene.sight({5, 0, -1.5}), 25.0);
  ASSERT_TRUE(ahead.has_value());
  EXPECT_EQ(ahead->sight.slot, 0);
  EXPECT_FALSE(ahead->sight.behind);
  EXPECT_GT(ahead->margin, 3.0);
  const auto other = associate(scene.filter, *scene.sight({8, 2.5, -1.5}), 25.0);
  ASSERT_TRUE(other.has_value());
  EXPECT_EQ(other->sight.slot, 1);
  EXPECT_TRUE(other->sight.behind) << "it is flown through southwards";
}

TEST(Association, AGateWhereTheMapHasNoneIsNone) {
  const Scene scene;
  EXPECT_FALSE(associate(scene.filter, *scene.sight({5, -3.0, -1.5}), 25.0).has_value());
  EXPECT_FALSE(associate(scene.filter, *scene.sight({2.5, 0.0, -1.5}), 25.0).has_value());
}

TEST(Association, LowerCornersAndBarsAreSightingsToo) {
  const Scene scene;
  const PictureClock clock{scene.rig, scene.timing, 1.0, {315.0, 160.0}};
  const auto lower = sight_of(LowerCorners{{100, 120}, {200, 120}, 1.0}, clock);
  ASSERT_TRUE(lower.has_value());
  EXPECT_EQ(lower->features.size(), 2u);
  EXPECT_EQ(lower->features[0].which, 3) << "bottom left";
  EXPECT_EQ(lower->features[1].which, 2) << "bottom right";
  const auto bars = sight_of(GateBars{{100, 80}, {200, 80}}, clock);
  ASSERT_TRUE(bars.has_value());
  EXPECT_EQ(bars->features[0].kind, eskf::Feature::Kind::kBar);
  EXPECT_NEAR(bars->time, 1.0 - 0.044, 1e-9);
}

// Any corners of a gate that the border cuts: those of fitness 0 are not in view.
TEST(Association, TwoOrThreeCornersOfACutGateAreASighting) {
  const Scene scene;
  const PictureClock clock{scene.rig, scene.timing, 100 * Scene::kDt + 0.02, {315.0, 160.0}};
  const auto corners = scene.corners({5, 0, -1.5});
  const auto seen = [&](std::array<double, 4> fitness) {
    return sight_of_cut({.corners_px = corners, .corner_fitness = fitness, .whole = false}, clock);
  };
  for (const auto& [fitness, first, count] : {std::tuple{std::array<double, 4>{1, 1, 0, 0}, 0, 2u},
                                              {{0, 1, 1, 0}, 1, 2u},
                                              {{1, 0, 1, 0}, 0, 2u},
                                              {{0, 1, 1, 1}, 1, 3u}}) {
    const auto sight = seen(fitness);
    ASSERT_TRUE(sight.has_value());
    ASSERT_EQ(sight->features.size(), count);
    EXPECT_EQ(sight->features[0].which, first);
    EXPECT_EQ(sight->quality, eskf::GateSight::Quality::kPart);
    const auto innovation = scene.filter.innovation_of(*sight);
    ASSERT_TRUE(innovation.has_value());
    EXPECT_EQ(innovation->rows, static_cast<int>(2 * count));
    EXPECT_LT(innovation->nis, 4.0) << "where the gate is";
  }
  EXPECT_FALSE(seen({0, 0, 1, 0})) << "one corner says too little";
}

// A camera that reads its rows from above: what is low in the picture was exposed later.
TEST(Association, ARollingShutterOverRowsExposesTheLowerCornersLater) {
  const Scene scene;
  const CameraTiming rows{.latency = 0.044, .readout = 0.0, .readout_down = 0.016};
  const PictureClock clock{scene.rig, rows, 1.0, {640.0, 360.0}};
  const auto sight = sight_of(Quad{{{100, 90}, {200, 90}, {200, 270}, {100, 270}}}, clock);
  ASSERT_TRUE(sight.has_value());
  EXPECT_NEAR(sight->time, 1.0 - 0.044, 1e-12) << "in the middle of the picture";
  for (const std::size_t upper : {0u, 1u}) EXPECT_NEAR(sight->features[upper].late, -0.004, 1e-12);
  for (const std::size_t lower : {2u, 3u}) EXPECT_NEAR(sight->features[lower].late, 0.004, 1e-12);
  const auto low = sight_of(Quad{{{100, 180}, {200, 180}, {200, 360}, {100, 360}}}, clock);
  EXPECT_NEAR(low->time, 1.0 - 0.044 + 0.25 * 0.016, 1e-12);
}

}  // namespace
}  // namespace gatefly
