// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/scorer.hpp"

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/solids.hpp"

#include "support/matchers.hpp"

namespace gatefly::simulated_race {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A camera at 1.5 m that looks north along the floor, and a gate 4 m before it.
struct Scene {
  Scene() {
    camera.p_BC.setZero();
    camera.tilt_down = 0.0;
    camera.lens = {Pinhole{{168, 168}, {157, 80}}};
    world.room_size = {60, 60, 20};
    world.gates = {{.p_EG = {4, 0, -1.5}}};
    pose.p_EB = {0, 0, -1.5};
  }
  [[nodiscard]] std::optional<Quad> visible(std::size_t gate = 0) const {
    const sim::SolidSight sight{world};
    return Scorer{world, camera}.visible_gate(pose, world.gates[gate], &sight);
  }
  void turn(const Attitude& attitude) {
    const Quaternion q = quaternion_of(attitude);
    pose.q_EB = {q.w, q.x, q.y, q.z};
  }
  /// After one picture with these quads in it.
  [[nodiscard]] Scorer scored(const std::vector<Quad>& quads) const {
    Sighting sighting;
    for (const Quad& quad : quads) (void)sighting.detections.push_back({.corners_px = quad});
    Scorer scorer{world, camera};
    scorer.score(pose, sighting, 0, sim::SolidSight{world});
    return scorer;
  }
  world::World world;
  world::CameraTruth camera;
  sim::BodyPose pose;
};

Quad moved(Quad quad, double du, double dv = 0.0) {
  for (Vector2d& corner : quad) corner += Vector2d{du, dv};
  return quad;
}

TEST(VisibleGate, CornersAreWhereAPinholeDrawsThem) {
  const Quad quad = Scene{}.visible().value();
  const double h = 168 * 0.5 / 4;  // focal length times half the side by the distance
  const Quad expected{Vector2d{157 - h, 80 - h}, Vector2d{157 + h, 80 - h},
                      Vector2d{157 + h, 80 + h}, Vector2d{157 - h, 80 + h}};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_THAT(quad[i], test::IsNear(expected[i], 1e-9)) << i;
}

TEST(VisibleGate, TurnsWithBodyMountAndGate) {
  Scene scene;
  scene.camera.p_BC = {0.1, 0.02, -0.03};
  scene.camera.tilt_down = 0.2;
  scene.world.gates[0] = {.p_EG = {4, 0.5, -1.4}, .yaw_EG = 0.4, .side = 1.2};
  const Attitude attitude{0.1, -0.05, 0.15};
  scene.turn(attitude);
  const Quad quad = scene.visible().value();
  const Eigen::Matrix3d R_EB = rotation_EB(attitude).matrix;
  const Vector3d eye_E = scene.pose.p_EB + R_EB * scene.camera.p_BC;
  const Vector3d lower_right_E = Vector3d{4, 0.5, -1.4} + rotation_z(0.4) * Vector3d{0, 0.6, 0.6};
  const Vector3d p_C =
      camera_mount(0.2).matrix.transpose() * (R_EB.transpose() * (lower_right_E - eye_E));
  EXPECT_THAT(
      quad[2],
      test::IsNear(Vector2d{157 + 168 * p_C.x() / p_C.z(), 80 + 168 * p_C.y() / p_C.z()}, 1e-9));
}

TEST(VisibleGate, OnlyWholeAndFromTheFront) {
  Scene scene;
  scene.world.gates[0].yaw_EG = kPi;
  EXPECT_FALSE(scene.visible()) << "from behind";
  scene.world.gates[0].yaw_EG = 0.0;
  for (const double yaw : {-0.5, 0.5, 0.8, kPi}) {
    scene.turn({0, 0, yaw});
    EXPECT_EQ(scene.visible().has_value(), std::abs(yaw) < 0.6) << yaw << ": partly outside";
  }
  scene.turn({});
  scene.world.gates[0].p_EG.x() = 0.9;
  EXPECT_FALSE(scene.visible()) << "too near to be whole";
}

// 315 x 160 upright, however it is stored: a gate at the right border is in view, one below the lower
// border is not. Turned by 90 or 270 degrees the picture is stored 160 wide.
TEST(VisibleGate, IsInsideTheUprightPictureHoweverItIsStored) {
  for (const int rotation : {0, 90, 180, 270}) {
    Scene scene;
    const bool turned = rotation % 180 != 0;
    scene.camera.stored_rotation = rotation;
    scene.pose.p_EB.z() = -8.0;  // the floor is far below
    scene.camera.stored_width = turned ? 160 : 315, scene.camera.stored_height = turned ? 315 : 160;
    const auto seen_at = [&](double u, double v) {  // a square of 42 px around there
      scene.world.gates[0].p_EG = {4, 4 * (u - 157) / 168, -8.0 + 4 * (v - 80) / 168};
      return scene.visible().has_value();
    };
    for (const double u : {22.0, 157.0, 200.0, 292.0})
      for (const double v : {22.0, 80.0, 137.0})
        EXPECT_TRUE(seen_at(u, v)) << u << ' ' << v << " stored " << rotation;
    for (const double u : {20.0, 294.0})
      EXPECT_FALSE(seen_at(u, 80)) << u << " stored " << rotation;
    for (const double v : {20.0, 139.0, 200.0})
      EXPECT_FALSE(seen_at(157, v)) << v << " stored " << rotation;
  }
}

TEST(VisibleGate, AHiddenCornerHidesIt) {
  Scene scene;
  scene.world.obstacles = {{{2.0, 0.25}, {0.1, 0.1}, 0.0, 0.0, 1.5, false}};
  EXPECT_FALSE(scene.visible());
  scene.world.obstacles[0].center = {4.5, 0.25};  // behind the gate
  EXPECT_TRUE(scene.visible());
  EXPECT_TRUE(
      Scorer(scene.world, scene.camera).visible_gate(scene.pose, scene.world.gates[0], nullptr));
}

TEST(Scorer, AHitCoversSeventyPercentOfBothAreas) {
  const Scene scene;
  const Quad gate = scene.visible().value();
  const double side = gate[1].x() - gate[0].x();
  struct Case {
    Quad quad;
    int hits;
  };
  for (const Case& one :
       {Case{gate, 1}, Case{moved(gate, 0.29 * side), 1}, Case{moved(gate, 0.31 * side), 0},
        Case{moved(gate, 0, -0.29 * side), 1}, Case{scaled(gate, 0.84), 1},
        Case{scaled(gate, 0.83), 0}, Case{scaled(gate, 1.19), 1}, Case{scaled(gate, 1.21), 0}}) {
    const Scorer scorer = scene.scored({one.quad});
    EXPECT_EQ(scorer.true_positives(), one.hits);
    EXPECT_EQ(scorer.false_positives(), 0) << "half of a gate is no false alarm";
  }
}

TEST(Scorer, CountsPicturesAndThoseThatShowTheTarget) {
  Scene scene;
  EXPECT_EQ(scene.scored({}).frames(), 1);
  EXPECT_EQ(scene.scored({}).frames_with_gate(), 1);
  EXPECT_EQ(scene.scored({}).true_positives(), 0) << "a miss";
  scene.turn({0, 0, kPi});
  EXPECT_EQ(scene.scored({}).frames(), 1);
  EXPECT_EQ(scene.scored({}).frames_with_gate(), 0);
}

TEST(Scorer, ASecondHitCountsNeitherWay) {
  const Scene scene;
  const Quad gate = scene.visible().value();
  const Scorer scorer = scene.scored({gate, moved(gate, 1.0)});
  EXPECT_EQ(scorer.true_positives(), 1);
  EXPECT_EQ(scorer.false_positives(), 0);
}

TEST(Scorer, WhatIsNoGateIsAFalsePositive) {
  const Scene scene;
  const Quad gate = scene.visible().value();
  const double side = gate[1].x() - gate[0].x();
  for (const Quad& wrong : {moved(gate, 0.51 * side), moved(gate, -90), scaled(gate, 0.69)}) {
    const Scorer scorer = scene.scored({wrong, gate});
    EXPECT_EQ(scorer.true_positives(), 1) << "the other one hits";
    EXPECT_EQ(scorer.false_positives(), 1);
  }
}

TEST(Scorer, AnotherGateIsNeitherHitNorFalsePositive) {
  Scene scene;
  scene.world.gates.push_back({.p_EG = {5, 2.0, -1.5}});
  const Quad other = scene.visible(1).value();
  EXPECT_EQ(scene.scored({other}).true_positives(), 0);
  EXPECT_EQ(scene.scored({other}).false_positives(), 0);
  scene.world.gates[1].yaw_EG = kPi;  // from behind it is none
  EXPECT_EQ(scene.scored({other}).false_positives(), 1);
}

TEST(Scorer, AHiddenGateIsNotAskedForAndNotHeldAgainstThePilot) {
  Scene scene;
  const Quad gate = scene.visible().value();
  scene.world.obstacles = {{{2.0, 0.25}, {0.1, 0.1}, 0.0, 0.0, 1.5, false}};  // before one corner
  const Scorer scorer = scene.scored({gate});
  EXPECT_EQ(scorer.frames_with_gate(), 0);
  EXPECT_EQ(scorer.true_positives(), 0);
  EXPECT_EQ(scorer.false_positives(), 0);
}

}  // namespace
}  // namespace gatefly::simulated_race
