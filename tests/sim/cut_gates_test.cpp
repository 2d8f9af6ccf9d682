// SPDX-License-Identifier: Apache-2.0
// Wide gates that the border cuts: what is in view of them, and what ideal vision tells of it.
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/ideal_vision.hpp"
#include "gatefly/sim/solids.hpp"

namespace gatefly::sim {
namespace {

/// A gate of 2.7 m on the floor of a hall; a camera 1.35 m above it that looks up by 20 degrees.
struct WideHall {
  explicit WideHall(double distance) {
    world.room_size = {60, 60, 20};
    world.gates = {{.p_EG = {distance, 0.0, -1.35}, .side = 2.7, .bar = 0.6}};
    camera.p_BC.setZero();
    camera.tilt_down = -0.35;
    camera.lens = {Pinhole{{320, 320}, {319.5, 179.5}}};
    camera.stored_width = 640, camera.stored_height = 360, camera.stored_rotation = 0;
    camera.readout = 0.0;
  }
  [[nodiscard]] GateView view() const {
    const SolidSight sight{world};
    return gates_in_view(world, camera, sight, 0.0, history()).at(0);
  }
  [[nodiscard]] static std::vector<BodyPose> history() {
    return {{-1.0, {0, 0, -1.35}, {1, 0, 0, 0}}, {1.0, {0, 0, -1.35}, {1, 0, 0, 0}}};
  }
  world::World world;
  world::CameraTruth camera;
};

TEST(CutKind, NamesThePairsOfCorners) {
  EXPECT_EQ(cut_kind({true, true, false, false}), CutKind::kUpper);
  EXPECT_EQ(cut_kind({false, false, true, true}), CutKind::kLower);
  EXPECT_EQ(cut_kind({true, false, false, true}), CutKind::kSide);
  EXPECT_EQ(cut_kind({false, true, true, false}), CutKind::kSide);
  EXPECT_EQ(cut_kind({true, false, true, false}), CutKind::kDiagonal);
  EXPECT_EQ(cut_kind({false, true, false, true}), CutKind::kDiagonal);
  EXPECT_EQ(cut_kind({true, true, false, true}), CutKind::kThree);
  EXPECT_FALSE(cut_kind({true, true, true, true}));
  EXPECT_FALSE(cut_kind({false, true, false, false}));
}

// From the front and from behind.
TEST(GatesInView, CornersOfBoardsAreThoseOfTheFaceThatShows) {
  for (const double yaw : {0.0, kPi}) {
    WideHall deep{8.0}, nearer{7.87};
    deep.world.gates[0].yaw_EG = nearer.world.gates[0].yaw_EG = yaw;
    deep.world.gates[0].depth = 0.26, nearer.world.gates[0].depth = 0.0;
    const GateView board = deep.view(), paper = nearer.view();
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR((board.corners_px[i] - paper.corners_px[i]).norm(), 0.0, 1e-9) << yaw;
  }
  WideHall thin{4.0}, same{4.0};
  thin.world.gates[0].side = same.world.gates[0].side = 1.0;
  thin.world.gates[0].bar = same.world.gates[0].bar = 0.05;
  same.world.gates[0].depth = 0.2;
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(thin.view().corners_px[i], same.view().corners_px[i]) << "on their axes";
}

// A camera tilted up loses the lower corners first: the outer ones before those of the opening.
TEST(GatesInView, TellOuterAndInnerCornersApart) {
  const GateView far = WideHall{12.0}.view(), near = WideHall{5.0}.view();
  EXPECT_TRUE(far.whole);
  EXPECT_EQ(far.inner_seen, (std::array<bool, 4>{true, true, true, true}));
  EXPECT_EQ(near.seen, (std::array<bool, 4>{true, true, false, false}));
  EXPECT_EQ(near.inner_seen, (std::array<bool, 4>{true, true, true, true}));
  EXPECT_EQ(near.drawn, (std::array<bool, 4>{true, true, true, true}));
  EXPECT_NEAR(near.side_px, 320 * 2.7 / 5.0, 1e-2);
}

// The part in view of a cut gate is found as often, and as well, as the table of wide gates has it;
// nothing is said of corners that are not in view.
TEST(IdealVision, TellsTheCornersInViewOfACutGateAsItsTableHasThem) {
  const WideHall hall{5.0};
  const GateView view = hall.view();
  const SolidSight sight{hall.world};
  const auto& bins =
      statistics_of("ours", GateBuild::kWide).cuts.kinds[static_cast<std::size_t>(CutKind::kUpper)];
  const CutBin& bin = view.side_px < bins[0].below_px   ? bins[0]
                      : view.side_px < bins[1].below_px ? bins[1]
                                                        : bins[2];
  constexpr int kSeeds = 3000;
  int seen = 0;
  double square = 0.0;
  for (int i = 0; i < kSeeds; ++i) {
    IdealVision vision{hall.world,
                       hall.camera,
                       {.detector = "ours", .false_alarms = 0.0},
                       static_cast<std::uint64_t>(1000 + i),
                       sight};
    const SeenPicture picture = vision.look(0.0, WideHall::history());
    EXPECT_FALSE(picture.lower);
    if (!picture.cut) continue;
    ++seen;
    EXPECT_EQ(picture.cut->seen, view.seen);
    for (const std::size_t c : {0u, 1u})
      square += (picture.cut->corners_px[c] - view.corners_px[c]).squaredNorm() / 4.0;
  }
  EXPECT_NEAR(seen / double(kSeeds), bin.rate, 4.0 * std::sqrt(0.25 / kSeeds));
  if (seen > 100) {
    EXPECT_NEAR(std::sqrt(square / seen), bin.sigma_px, 0.15 * bin.sigma_px);
  }
}

TEST(IdealVision, ThinGatesHaveNoCutOnes) {
  WideHall hall{2.0};
  hall.world.gates[0].side = 1.0, hall.world.gates[0].bar = 0.05;
  EXPECT_EQ(build_of(hall.world.gates), GateBuild::kThin);
  const SolidSight sight{hall.world};
  IdealVision vision{hall.world, hall.camera, {.detector = "ours"}, 1001, sight};
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(vision.look(0.05 * i, WideHall::history()).cut);
}

}  // namespace
}  // namespace gatefly::sim
