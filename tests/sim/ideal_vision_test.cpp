// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/ideal_vision.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

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
  world::World world;
  world::CameraTruth camera;
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
  // The lens puts them half a metre aside at four metres.
  const world::CameraTruth camera;
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

constexpr double kPicture = 1.0 / 15.0;  // [s]

double side_of(const GateView& view) {
  const Eigen::Vector2d a = view.corners_px[2] - view.corners_px[0],
                        b = view.corners_px[3] - view.corners_px[1];
  return std::sqrt(0.5 * std::abs(a.x() * b.y() - a.y() * b.x()));
}

const SizeBin& bin_of(const DetectorStatistics& statistics, double side_px) {
  for (const SizeBin& bin : statistics.gates)
    if (side_px < bin.below_px) return bin;
  return statistics.gates.back();
}

/// The same camera looks at the same gate with many seeds: pictures that follow each other.
struct Looking {
  Hall hall;
  const char* detector;
  int seeds = 2000, pictures = 2;
  double false_alarms = 0.0;

  /// each(number of the seed, picture, what was seen)
  template <class Each>
  void operator()(const Each& each) const {
    const SolidSight sight{hall.world};
    const auto history = Hall::history();
    for (int nth = 0; nth < seeds; ++nth) {
      IdealVision vision{hall.world,
                         hall.camera,
                         {.detector = detector, .false_alarms = false_alarms},
                         static_cast<std::uint64_t>(1000 + nth),
                         sight};
      for (int i = 0; i < pictures; ++i) each(nth, i, vision.look(1.0 + i * kPicture, history));
    }
  }
};

TEST(IdealVision, FindsGatesAsOftenAsItsTableSaysWithTheFitnessOfItsTable) {
  for (const char* detector : {"ours", "paper"})
    for (const double distance : {1.9, 2.8, 3.7, 5.5}) {
      const Looking looking{.hall = Hall{distance, 1.3}, .detector = detector, .pictures = 1};
      const SizeBin& bin = bin_of(statistics_of(detector), side_of(looking.hall.views()[0]));
      int hits = 0, below = 0, above = 0;
      looking([&](int, int, const SeenPicture& seen) {
        hits += static_cast<int>(seen.gates.size());
        if (seen.gates.empty()) return;
        below += seen.gates[0].fitness <= bin.fitness[5];
        above += seen.gates[0].fitness >= bin.fitness[5];
      });
      // Five standard deviations of a binomial count.
      EXPECT_NEAR(hits / double{2000}, bin.rate,
                  5.0 * std::sqrt(bin.rate * (1.0 - bin.rate) / 2000) + 1e-9)
          << detector << ' ' << distance;
      if (hits > 50) {
        const double least = 0.5 - 5.0 * 0.5 / std::sqrt(hits);
        EXPECT_GE(below / double(hits), least) << detector << ' ' << distance;
        EXPECT_GE(above / double(hits), least) << detector << ' ' << distance;
      }
    }
}

TEST(IdealVision, MissesComeInRows) {
  const Looking looking{.hall = Hall{3.0, 1.3}, .detector = "paper"};
  int misses = 0, again = 0, looks = 0;
  bool missed = false;
  looking([&](int, int picture, const SeenPicture& seen) {
    const bool miss = seen.gates.empty();
    ++looks, misses += miss;
    if (picture == 1 && missed) again += miss;
    missed = miss;
  });
  const double rate = misses / double(looks);
  // Two pictures on: two standard normal numbers that share the seed's and the staying part.
  const Staying& staying = statistics_of("paper").staying;
  const double shared = staying.seed + staying.row * std::exp(-kPicture / staying.time);
  EXPECT_GT(again / (0.5 * misses), rate + 0.6 * shared * (1.0 - rate)) << rate;
  EXPECT_LT(again / (0.5 * misses), 1.0 - 0.5 * (1.0 - shared) * (1.0 - rate)) << rate;
}

TEST(IdealVision, WhatCornersShareStaysForAWhile) {
  const Looking looking{.hall = Hall{3.0, 1.3}, .detector = "ours"};
  const auto truth = looking.hall.views()[0].corners_px;
  std::vector<double> last;
  double product = 0.0, square = 0.0;
  looking([&](int, int picture, const SeenPicture& seen) {
    if (picture == 0) last.clear();
    if (seen.gates.empty()) return;
    double off = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
      off += 0.25 * (seen.gates[0].corners_px[i].x() - truth[i].x());
    if (!last.empty()) product += off * last[0], square += 0.5 * (off * off + last[0] * last[0]);
    last = {off};
  });
  const CornerErrors& errors = statistics_of("ours").corners;
  const double own = errors.own * errors.own / 4 / (errors.together * errors.together);
  // Few corners are outliers, but far ones; they do not stay. Half of their mean square along x.
  const double low = errors.outlier_low, high = errors.outlier_high;
  const double far = errors.outlier_rate * (low * low + low * high + high * high) / 3 / 2 / 4 /
                     (errors.together * errors.together);
  const double expected = errors.stays * std::exp(-kPicture / errors.time) / (1.0 + own + far);
  EXPECT_NEAR(product / square, expected, 0.15);
}

/// Alarms in a hall without gates, with many times the detector's rate.
TEST(IdealVision, FalseAlarmsStayWhereTheyAre) {
  Looking looking{.hall = Hall{3.0}, .detector = "ours", .false_alarms = 5.0};
  looking.hall.world.gates.clear();
  looking.hall.world.room_size = {9, 9, 3};
  int alarms = 0, stayed = 0, asked = 0;
  std::vector<Eigen::Vector2d> last;
  looking([&](int, int picture, const SeenPicture& seen) {
    std::vector<Eigen::Vector2d> now;
    for (const auto& gate : seen.gates)
      now.push_back(0.5 * (gate.corners_px[0] + gate.corners_px[2]));
    alarms += static_cast<int>(now.size());
    for (const auto& place : last) {
      if (picture == 0) break;
      ++asked;
      stayed += std::any_of(now.begin(), now.end(),
                            [&](const auto& other) { return (other - place).norm() < 10.0; });
    }
    last = now;
  });
  ASSERT_GT(alarms, 50);
  // At that very place; by chance it would be the rate of one place.
  EXPECT_GT(stayed / double(asked), 6.0 * 5.0 * statistics_of("ours").places.rate);
}

TEST(IdealVision, DecoysAreTakenForGatesAsOftenAsTheTableSays) {
  Looking looking{.hall = Hall{3.0}, .detector = "ours", .pictures = 1, .false_alarms = 1.0};
  looking.hall.world.gates.clear();
  const auto alarms = [&] {
    int count = 0;
    looking(
        [&](int, int, const SeenPicture& seen) { count += static_cast<int>(seen.gates.size()); });
    return count / double(looking.seeds);
  };
  const double without = alarms();
  looking.hall.world.decoys = {{.shape = {{4.0, 0.5}, {0.3, 0.3}, 0.0, 0.0, 1.5, false}},
                               {.shape = {{4.0, -0.5}, {0.2, 0.2}, 0.0, 0.0, 1.5, true}}};
  const double rate = statistics_of("ours").decoys.rate;
  EXPECT_NEAR(alarms() - without, 2 * rate, 5.0 * std::sqrt(2 * rate / looking.seeds) + 1e-9);
}

TEST(IdealVision, AFalseGateIsSeenAsAGate) {
  Hall hall{3.0};
  hall.world.gates.swap(hall.world.false_gates);
  const SolidSight sight{hall.world};
  IdealVision vision{hall.world, hall.camera, {.false_alarms = 0.0}, 1, sight};
  int seen = 0;
  for (int i = 0; i < 50; ++i)
    seen += static_cast<int>(vision.look(i * kPicture, Hall::history()).gates.size());
  EXPECT_GT(seen, 25);
}

TEST(LookAlikes, TwoGatesSideBySideMakeAFrameOfTheirNearBars) {
  Hall hall{4.0};
  hall.world.gates = {{.p_EG = {4.0, -1.0, -1.0}}, {.p_EG = {4.0, 1.0, -1.0}}};
  const auto views = hall.views();
  ASSERT_EQ(views.size(), 2u);
  const auto frames = frames_of_two(views);
  // Left gate's right bar and right gate's left bar; the others are wider than high.
  ASSERT_EQ(frames.size(), 1u);
  const world::CameraTruth camera;
  EXPECT_LT((frames[0].corners_px[0] - *camera.lens.project({-0.5, -0.5, 4.0})).norm(), 1e-9);
  EXPECT_LT((frames[0].corners_px[2] - *camera.lens.project({0.5, 0.5, 4.0})).norm(), 1e-9);
  hall.world.gates.pop_back();
  EXPECT_TRUE(frames_of_two(hall.views()).empty());
}

TEST(LookAlikes, DecoysAndPlacesBehindSomethingAreNotInView) {
  Hall hall{4.0};
  hall.world.decoys = {{.shape = {{4.0, 0.0}, {0.3, 0.3}, 0.0, 0.0, 1.5, false}}};
  const auto history = Hall::history();
  const auto in_view = [&] {
    const SolidSight sight{hall.world};
    Exposure exposure{hall.camera, 0.0, history};
    return decoys_in_view(hall.world, sight, exposure).size();
  };
  EXPECT_EQ(in_view(), 1u);
  hall.world.obstacles = {{{2.0, 0.0}, {0.1, 2.0}, 0.0, 0.0, 2.5, false}};
  EXPECT_EQ(in_view(), 0u);
}

// Another thing in view, another picture lost: what is drawn for this gate stays.
TEST(IdealVision, WhatIsDrawnForOneGateDoesNotDependOnAnother) {
  Hall one{3.0, 1.2};
  Hall two = one;
  two.world.gates.push_back({.p_EG = {5.0, -2.2, -1.2}});
  ASSERT_TRUE(two.views()[1].whole);
  const SolidSight sight_one{one.world}, sight_two{two.world};
  IdealVision alone{one.world, one.camera, {.false_alarms = 0.0}, 3, sight_one},
      beside{two.world, two.camera, {.false_alarms = 0.0}, 3, sight_two};
  for (int i = 0; i < 60; ++i) {
    const auto a = alone.look(i * kPicture, Hall::history()).gates;
    if (i % 5 == 4) continue;  // a picture that the other does not take
    const auto b = beside.look(i * kPicture, Hall::history()).gates;
    for (const auto& gate : a)
      EXPECT_TRUE(std::any_of(b.begin(), b.end(), [&](const auto& other) {
        return other.corners_px == gate.corners_px && other.fitness == gate.fitness;
      })) << i;
  }
}

TEST(IdealVision, SeesNothingWithItsBackToTheGate) {
  const Looking looking{.hall = Hall{-4.0}, .detector = "ours", .seeds = 20};
  looking([](int, int, const SeenPicture& seen) { EXPECT_TRUE(seen.gates.empty()); });
}

TEST(IdealVision, TheSameSeedDrawsTheSameErrors) {
  const Hall hall{3.0};
  const SolidSight sight{hall.world};
  IdealVision one{hall.world, hall.camera, {}, 5, sight},
      two{hall.world, hall.camera, {}, 5, sight}, other{hall.world, hall.camera, {}, 6, sight};
  bool differs = false;
  for (int i = 0; i < 20; ++i) {
    const double t = i * kPicture;
    const auto a = one.look(t, Hall::history()).gates, b = two.look(t, Hall::history()).gates,
               c = other.look(t, Hall::history()).gates;
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
    const SeenPicture seen = vision.look(i * kPicture, Hall::history());
    EXPECT_TRUE(seen.gates.empty() && !seen.lower && !seen.bars);
  }
}

}  // namespace
}  // namespace gatefly::sim
