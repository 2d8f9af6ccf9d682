// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/ideal_vision.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/solids.hpp"

namespace gatefly::sim {
namespace {

/// One gate in an empty hall, straight before the camera.
struct Hall {
  explicit Hall(double distance, double height = 1.0, double yaw = 0.0) {
    world.room_size = {60, 60, 20};
    world.gates = {{.p_EG = {distance, 0.0, -height}, .yaw_EG = yaw}};
    camera.p_BC.setZero();
    camera.tilt_down = 0.0;
  }
  [[nodiscard]] std::vector<GateView> views(double yaw_rate = 0.0) const {
    const SolidSight sight{world};
    return gates_in_view(world, camera, sight, 0.0, history(yaw_rate));
  }
  [[nodiscard]] static std::vector<BodyPose> history(double yaw_rate = 0.0) {
    std::vector<BodyPose> poses;
    for (int i = -5; i <= 40; ++i) {
      poses.push_back({1e-3 * i, {0, 0, -1.0}, q_EB_of({0.0, 0.0, yaw_rate * (1e-3 * i - 0.014)})});
    }
    return poses;
  }
  World world;
  CameraTruth camera;
};

TEST(GatesInView, AGateStraightAheadIsWholeAndClockwiseFromTopLeft) {
  const auto views = Hall{4.0}.views();
  ASSERT_EQ(views.size(), 1u);
  EXPECT_TRUE(views[0].whole);
  EXPECT_FALSE(views[0].only_lower_corners);
  EXPECT_NEAR(views[0].distance, 4.0, 1e-9);
  const auto& c = views[0].corners_px;
  EXPECT_LT(c[0].x(), c[1].x());
  EXPECT_LT(c[0].y(), c[3].y());
  EXPECT_LT(c[3].x(), c[2].x());
  // Where the lens puts them: half a metre aside at four metres.
  const CameraTruth camera;
  EXPECT_LT((c[2] - *camera.lens.project({0.5, 0.5, 4.0})).norm(), 1e-9);
}

TEST(GatesInView, FromBehindTheLeftCornersAreStillLeft) {
  const auto views = Hall{4.0, 1.0, 3.141592653589793}.views();
  ASSERT_EQ(views.size(), 1u);
  EXPECT_TRUE(views[0].whole);
  EXPECT_LT(views[0].corners_px[0].x(), views[0].corners_px[1].x());
}

TEST(GatesInView, AGateThatIsTooHighForThePictureIsOpen) {
  Hall hall{2.0, 1.55};
  hall.camera.tilt_down = 0.35;
  const auto views = hall.views();
  ASSERT_EQ(views.size(), 1u);
  EXPECT_FALSE(views[0].whole);
  EXPECT_TRUE(views[0].only_lower_corners);
}

TEST(GatesInView, CloseUpTheSideBarsAreLeft) {
  const auto views = Hall{0.9}.views();
  ASSERT_EQ(views.size(), 1u);
  EXPECT_FALSE(views[0].whole);
  ASSERT_TRUE(views[0].bars_px);
  EXPECT_LT((*views[0].bars_px)[0].x(), (*views[0].bars_px)[1].x());
}

TEST(GatesInView, WhatStandsBeforeACornerHidesIt) {
  Hall hall{4.0};
  hall.world.obstacles = {{{2.0, 0.25}, {0.1, 0.1}, 0.0, 0.0, 1.5, false}};
  EXPECT_FALSE(hall.views()[0].whole);
  hall.world.obstacles[0].center = {5.0, 0.25};
  EXPECT_TRUE(hall.views()[0].whole);
}

// Turning right while the columns are read from left to right: what is right is drawn later,
// further left.
TEST(GatesInView, ATurningCameraDrawsEachColumnAtItsOwnTime) {
  const auto still = Hall{4.0}.views()[0].corners_px, turning = Hall{4.0}.views(2.0)[0].corners_px;
  const double still_width = still[1].x() - still[0].x(), width = turning[1].x() - turning[0].x();
  const double between = 0.020 * still_width / 314.0;  // [s]
  EXPECT_LT(width, still_width);
  EXPECT_NEAR(still_width - width, 2.0 * between * 168.0, 0.3);
}

struct Counts {
  int hits = 0, alarms = 0;
  double error2 = 0.0;
};

Counts look_often(const Hall& hall, const std::string& detector, int times) {
  const SolidSight sight{hall.world};
  IdealVision vision{hall.world, hall.camera, {detector}, 5, sight};
  const auto truth = hall.views()[0].corners_px;
  Counts counts;
  for (int i = 0; i < times; ++i)
    for (const auto& gate : vision.look(0.0, Hall::history()).gates) {
      double error2 = 0.0;
      for (std::size_t k = 0; k < 4; ++k)
        error2 = std::max(error2, (gate.corners_px[k] - truth[k]).squaredNorm());
      if (gate.fitness < 0.8)
        ++counts.alarms;
      else
        ++counts.hits, counts.error2 += error2;
    }
  return counts;
}

TEST(IdealVision, FindsGatesAsOftenAsItsTableSays) {
  constexpr int kTimes = 4000;
  for (const char* detector : {"ours", "paper"}) {
    const DetectorStatistics statistics = statistics_of(detector);
    for (const double distance : {1.9, 2.8, 3.7, 4.7, 7.4}) {
      double expected = 0.0, below = 0.0;
      for (const HitRate& bin : statistics.hits) {
        if (distance >= below && distance < bin.below) expected = bin.rate;
        below = bin.below;
      }
      const Counts counts = look_often(Hall{distance, 1.3}, detector, kTimes);
      // Five standard deviations of a binomial count.
      EXPECT_NEAR(counts.hits / double{kTimes}, expected,
                  5.0 * std::sqrt(expected * (1.0 - expected) / kTimes) + 1e-9)
          << detector << ' ' << distance;
      EXPECT_NEAR(counts.alarms / double{kTimes}, statistics.false_alarms,
                  5.0 * std::sqrt(statistics.false_alarms / kTimes));
    }
  }
}

TEST(IdealVision, SeesNothingWithItsBackToTheGate) {
  const Counts counts = look_often(Hall{-4.0}, "ours", 1);
  EXPECT_EQ(counts.hits, 0);
}

TEST(IdealVision, TheSameSeedDrawsTheSameErrors) {
  const Hall hall{3.0};
  const SolidSight sight{hall.world};
  IdealVision one{hall.world, hall.camera, {}, 5, sight},
      two{hall.world, hall.camera, {}, 5, sight}, other{hall.world, hall.camera, {}, 6, sight};
  bool differs = false;
  for (int i = 0; i < 20; ++i) {
    const auto a = one.look(0.0, Hall::history()).gates, b = two.look(0.0, Hall::history()).gates,
               c = other.look(0.0, Hall::history()).gates;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].corners_px, b[k].corners_px);
    differs = differs || a.size() != c.size() || (!a.empty() && a[0].corners_px != c[0].corners_px);
  }
  EXPECT_TRUE(differs);
}

TEST(IdealVision, AnUnknownDetectorIsRefused) {
  EXPECT_THROW((void)statistics_of("theirs"), std::invalid_argument);
}

TEST(IdealVision, IsBlindToAGateOfAnotherColour) {
  Hall hall{3.0};
  hall.world.gates[0].sought = false;
  const SolidSight sight{hall.world};
  IdealVision vision{hall.world, hall.camera, {.false_alarms = 0.0}, 1, sight};
  for (int i = 0; i < 50; ++i) {
    const SeenPicture seen = vision.look(0.0, Hall::history());
    EXPECT_TRUE(seen.gates.empty() && !seen.lower && !seen.bars);
  }
}

}  // namespace
}  // namespace gatefly::sim
