// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/people.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "gatefly/sim/camera.hpp"
#include "gatefly/sim/scene.hpp"

namespace gatefly::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

world::Person walker() {
  return {.from = {2.0, -1.0}, .to = {2.0, 3.0}, .speed = 0.5, .start = 1.0, .height = 1.8};
}

TEST(People, WalkToTheEndAndBackAtTheirSpeed) {
  const world::Person person = walker();
  EXPECT_LT((place_of(person, 0.0) - Vector2d(2.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((place_of(person, 4.0) - Vector2d(2.0, 2.0)).norm(), 1e-12);
  EXPECT_LT((place_of(person, 6.0) - person.to).norm(), 1e-12);
  EXPECT_LT((place_of(person, 8.0) - Vector2d(2.0, 2.0)).norm(), 1e-12);
  EXPECT_LT((place_of(person, 14.0) - person.from).norm(), 1e-12);
  EXPECT_LT((place_of(person, 16.0) - place_of(person, 0.0)).norm(), 1e-12);
}

TEST(People, AreTouchedWhereTheyAreAndOnlyThen) {
  const std::array people{walker()};
  EXPECT_EQ(touched_person(people, {2.0, 0.3, -1.5}, 0.16, 0.0), 0);
  EXPECT_FALSE(touched_person(people, {2.0, 0.3, -1.5}, 0.16, 4.0)) << "gone on";
  EXPECT_FALSE(touched_person(people, {2.0, 0.5, -1.5}, 0.16, 0.0)) << "beside";
  EXPECT_FALSE(touched_person(people, {2.0, 0.0, -2.0}, 0.16, 0.0)) << "above the head";
}

TEST(People, AreDrawnInTheirPlaceAndSize) {
  world::World world;
  world.people = {walker(), {.from = {-3.0, 0.0}, .to = {-1.0, 0.0}}};
  const Scene scene = make_scene(world);
  ASSERT_EQ(scene.walkers.size(), 2u);
  for (const double t : {0.0, 3.0, 9.5}) {
    const std::vector<Rectangle> now = scene.walkers_at(t);
    ASSERT_EQ(now.size(), scene.walkers[0].rectangles + scene.walkers[1].rectangles);
    std::size_t next = 0;
    for (const Walker& walker : scene.walkers) {
      Vector3d low{9, 9, 9}, high = -low;
      for (std::size_t i = 0; i < walker.rectangles; ++i, ++next) {
        const Vector3d a = now[next].corner.cast<double>();
        const Vector3d b = a + (now[next].edge_u + now[next].edge_v).cast<double>();
        low = low.cwiseMin(a.cwiseMin(b)), high = high.cwiseMax(a.cwiseMax(b));
      }
      EXPECT_NEAR(-low.z(), walker.person.height, 1e-5);
      EXPECT_NEAR(high.z(), 0.0, 1e-5);
      EXPECT_LT((0.5 * (low + high).head<2>() - place_of(walker.person, t)).norm(), 0.02);
    }
  }
}

/// Frames that look north from (0, 0, -1.2).
class FrameOf {
 public:
  explicit FrameOf(const world::World& world) : renderer_{world, camera(), {}, 1, {}, 1} {}

  [[nodiscard]] std::vector<std::uint8_t> at(double t) {
    const std::vector<BodyPose> still{{t - 1.0, {0, 0, -1.2}}, {t + 1.0, {0, 0, -1.2}}};
    std::vector<std::uint8_t> uyvy;
    renderer_.meter_anew();
    renderer_.render(1, t, still, uyvy);
    return uyvy;
  }
  [[nodiscard]] const CameraRenderer& renderer() const { return renderer_; }

 private:
  static world::CameraTruth camera() {
    world::CameraTruth truth;
    truth.tilt_down = 0.0;
    return truth;
  }
  CameraRenderer renderer_;
};

world::World room_with_a_walker() {
  world::World world;
  world.room_size = {8, 8, 3.2};
  world.people = {{.from = {3.0, -2.0},
                   .to = {3.0, 2.0},
                   .speed = 1.0,
                   .shirt = {0.9, 0.9, 0.9},
                   .trousers = {0.9, 0.9, 0.9}}};
  return world;
}

TEST(People, AreSeenWhereTheyAreWhenThePictureIsTaken) {
  FrameOf frame{room_with_a_walker()};
  const auto before = frame.at(0.0), after = frame.at(2.0), again = frame.at(4.0 * 2.0);
  EXPECT_NE(before, after);
  EXPECT_EQ(before, again) << "back at the same end, the same picture";
}

TEST(People, HideWhatIsBehindThemAndStopRays) {
  FrameOf frame{room_with_a_walker()};
  const Vector3d eye{0, 0, -1.2}, behind{3.8, 0, -1.2};
  (void)frame.at(2.0);
  EXPECT_TRUE(frame.renderer().occluded(eye, behind));
  EXPECT_LT(frame.renderer().range(eye, {1, 0, 0}, 9.0), 3.1);
  (void)frame.at(0.0);
  EXPECT_FALSE(frame.renderer().occluded(eye, behind));
  EXPECT_NEAR(frame.renderer().range(eye, {1, 0, 0}, 9.0), 4.0, 1e-3);
}

}  // namespace
}  // namespace gatefly::sim
