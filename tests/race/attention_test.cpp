// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/attention.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector3d;

constexpr double kTick = 1.0 / 512;
const Vector3d kHover{0, 0, -1.5};

/// A drone that hovers and looks north, and what it believes of the gates around it.
struct LookingNorth {
  explicit LookingNorth(std::vector<eskf::Landmark> map) : filter{setup(std::move(map))} {
    rig.R_BC = camera_mount(0.0);
    filter.start({.p_EB = kHover, .rest_accel_B = {}}, 0.0);
    wait(100);
    filter.set_target(filter.landmarks().map(0).p_EG, filter.landmarks().map(0).yaw_EG);
  }
  static eskf::Setup setup(std::vector<eskf::Landmark> map) {
    eskf::Setup setup;
    setup.map = std::move(map);
    setup.R_BC = camera_mount(0.0).matrix;
    return setup;
  }
  void wait(int samples) {
    for (int i = 0; i < samples; ++i)
      filter.predict({Vector3d::Zero(), {0, 0, -9.81}}, kTick, (t += kTick));
  }
  [[nodiscard]] PictureClock picture() const {
    return {rig, timing, t, {315.0, 160.0}, 0.010, interval};
  }
  [[nodiscard]] std::optional<ExpectedGate> expected(int slot) const {
    return expected_gate(filter, slot, 0.0, picture());
  }

  double t = 0.0, interval = 0.033;
  CameraRig rig;
  CameraTiming timing{.latency = 0.044, .readout = 0.0};
  eskf::ErrorStateFilter filter;
};

eskf::Landmark gate_at(const Vector3d& p_EG, double yaw = 0.0) { return {p_EG, yaw, {}}; }

// The bars of a gate, seen by a drone that is elsewhere than it believes.
Quad seen_from(const LookingNorth& drone, const Vector3d& off, double turned, const Vector3d& p_EG,
               double yaw = 0.0) {
  Quad bars;
  const auto corners = gate_corners_G(0.95);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d p_B = rotation_z(-turned) * (p_EG + rotation_z(yaw) * corners[i] - kHover - off);
    bars[i] = drone.rig.lens.project(drone.rig.R_BC.matrix.transpose() * p_B).value();
  }
  return bars;
}

TEST(ExpectedGate, ShowsWhereTheLensPutsIt) {
  const Vector3d p_EG{4.0, 0.3, -1.4};
  const LookingNorth drone{{gate_at(p_EG)}};
  const auto expected = drone.expected(0);
  ASSERT_TRUE(expected);
  EXPECT_TRUE(expected->shows_whole);
  EXPECT_LT(largest_move(expected->bars_px, seen_from(drone, Vector3d::Zero(), 0.0, p_EG)), 1.5);
}

// Off by up to two and a half of its sigmas, the drone still finds the gate inside the window: gates that
// stand higher and are turned, after blind legs of every length.
TEST(ExpectedGate, TheWindowHoldsWhatTheSigmasAllow) {
  int tried = 0, far_off = 0;
  for_all(400, [&](Rng& rng) {
    const double yaw = rng.uniform(-0.9, 0.9);
    const Vector3d p_EG{rng.uniform(3.5, 7.0), rng.uniform(-1.0, 1.0), rng.uniform(-2.0, -1.0)};
    LookingNorth drone{{gate_at(p_EG, yaw)}};
    drone.wait(rng.uniform_index(1200));
    const auto expected = drone.expected(0);
    const auto sigma = [&](int state) { return drone.filter.sigma(state); };
    if (!expected || place_sigma(drone.filter) > 0.8) return;
    const double reach = 2.5 / std::sqrt(3.0);
    const Vector3d off{reach * rng.uniform(-1.0, 1.0) * sigma(eskf::kP),
                       reach * rng.uniform(-1.0, 1.0) * sigma(eskf::kP + 1),
                       reach * rng.uniform(-1.0, 1.0) * sigma(eskf::kP + 2)};
    const double turned = reach * rng.uniform(-1.0, 1.0) * sigma(eskf::kTheta + 2);
    const Quad bars = seen_from(drone, off, turned, p_EG, yaw);
    const SearchWindow& window = expected->window;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_GT(bars[i].x(), window.left);
      EXPECT_LT(bars[i].x(), window.right);
      EXPECT_GT(bars[i].y(), window.top);
      EXPECT_LT(bars[i].y(), window.bottom);
    }
    const Eigen::Vector2d down = 0.5 * (bars[3] - bars[0] + bars[2] - bars[1]);
    const double side = down.norm(),
                 width = 0.5 * (bars[1] - bars[0] + bars[2] - bars[3]).norm() / side;
    EXPECT_GT(side, window.least_side);
    EXPECT_LT(side, window.most_side);
    EXPECT_GT(width, window.least_width);
    EXPECT_LT(width, window.most_width);
    // Without the sigmas the window would end here.
    const double room = (0.25 * 0.95 + 0.06 * (p_EG - kHover).norm()) * side / 0.95;
    far_off += largest_move(bars, expected->bars_px) > room;
    ++tried;
  });
  EXPECT_GT(tried, 200);
  EXPECT_GT(far_off, 20) << "the sigmas' part of the window is needed";
}

TEST(ExpectedGate, IsNoneBehindTheLensOutOfThePictureOrSeenEdgeOn) {
  const LookingNorth drone{{gate_at({4, 0, -1.5}), gate_at({-4, 0, -1.5}), gate_at({1, 6, -1.5}),
                            gate_at({4, 0.5, -1.5}, 0.5 * kPi), gate_at({6, 0, -1.5}, kPi)}};
  EXPECT_TRUE(drone.expected(0));
  EXPECT_FALSE(drone.expected(1)) << "behind";
  EXPECT_FALSE(drone.expected(2)) << "far to the right";
  EXPECT_FALSE(drone.expected(3)) << "edge-on";
  EXPECT_TRUE(drone.expected(4)) << "from behind it is as good a gate";
}

TEST(ExpectedGate, OneThatTheBorderCutsDoesNotShowWhole) {
  const LookingNorth drone{{gate_at({3, 0, -1.5}), gate_at({3, 0, -4.4})}};
  EXPECT_TRUE(drone.expected(0)->shows_whole);
  ASSERT_TRUE(drone.expected(1));
  EXPECT_FALSE(drone.expected(1)->shows_whole);
}

constexpr Attention::Known kNow{.since_any = 0.05, .since_target = 0.05},
    kMissing{.since_any = 0.5, .since_target = 0.5}, kBlind{.since_any = 2.5, .since_target = 2.5};

struct Asked {
  int careful = 0, parts = 0, of_target = 0, others = 0;
};
Asked asked(Attention& attention, const LookingNorth& drone, const Attention::Known& known,
            int pictures) {
  Asked sum;
  for (int i = 0; i < pictures; ++i) {
    const LookFor look = attention.next(drone.filter, known, 0.0, drone.picture());
    EXPECT_EQ(look.quick, look.within == nullptr);
    if (look.quick) continue;
    ++sum.careful;
    if (!look.within->for_one)
      ++sum.parts;
    else if (look.gates == LookFor::Gates::kAll)
      ++sum.others;
    else
      ++sum.of_target;
  }
  return sum;
}

TEST(Attention, AGateThatIsFoundNeedsNoCarefulSearch) {
  const LookingNorth drone{{gate_at({4, 0, -1.5})}};
  Attention attention{{}};
  EXPECT_EQ(asked(attention, drone, kNow, 120).careful, 0);
}

TEST(Attention, WhereTheTargetIsMissingItIsSearchedAndNowAndThenElsewhereToo) {
  const LookingNorth drone{{gate_at({4, 0, -1.5})}};
  Attention attention{{}};
  const Asked sum = asked(attention, drone, kMissing, 120);
  EXPECT_EQ(sum.of_target, 100);
  EXPECT_EQ(sum.parts, 10);
}

TEST(Attention, WhileTheTargetIsMissingTheOtherGatesHaveTheirTurns) {
  const LookingNorth drone{{gate_at({4, 0, -1.5}), gate_at({6, 1.2, -1.5})}};
  Attention attention{{}};
  const Asked sum = asked(attention, drone, kMissing, 120);
  EXPECT_EQ(sum.of_target, 100);
  EXPECT_EQ(sum.parts, 10);
  EXPECT_EQ(sum.others, 10);
}

// A gate that only the careful search sees has to be seen twice within a short time after a blind leg.
TEST(Attention, APartThatShowsWhatHasToBeSeenTwiceIsSearchedAgainAtOnce) {
  const LookingNorth drone{{gate_at({-4, 0, -1.5})}};
  Attention attention{{}};
  Attention::Known known = kMissing;
  int repeated = 0;
  for (int i = 0; i < 120; ++i) {
    known.waits = false;
    const LookFor first = attention.next(drone.filter, known, 0.0, drone.picture());
    if (first.within == nullptr) continue;
    const SearchWindow before = *first.within;
    known.waits = true;
    const LookFor second = attention.next(drone.filter, known, 0.0, drone.picture());
    ASSERT_NE(second.within, nullptr);
    EXPECT_EQ(second.within->left, before.left);
    EXPECT_EQ(second.within->most_side, before.most_side);
    ++repeated;
  }
  EXPECT_GT(repeated, 5);
}

TEST(Attention, TheBlindSearchAPartInEveryThirdPicture) {
  const LookingNorth drone{{gate_at({4, 0, -1.5})}}, away{{gate_at({-4, 0, -1.5})}};
  Attention attention{{}};
  const Asked shown = asked(attention, drone, kBlind, 120);
  EXPECT_EQ(shown.parts, 40);
  EXPECT_EQ(shown.of_target, 80);
  EXPECT_EQ(asked(attention, away, kBlind, 120).parts, 40);
}

TEST(Attention, BesideATargetThatIsFoundTheOtherGatesHaveTheirTurns) {
  const LookingNorth drone{
      {gate_at({4, 0, -1.5}), gate_at({6, 1.2, -1.5}), gate_at({6, -1.2, -1.5}, kPi)}};
  Attention attention{{}};
  std::array<int, 2> sides{};
  for (int i = 0; i < 120; ++i) {
    const LookFor look = attention.next(drone.filter, kNow, 0.0, drone.picture());
    if (look.within == nullptr) continue;
    EXPECT_EQ(look.gates, LookFor::Gates::kAll);
    ++sides[look.within->left + look.within->right > 315.0];
  }
  EXPECT_EQ(sides[0], 10);
  EXPECT_EQ(sides[1], 10);
}

// No gate should show: parts of the picture alternate with the gates that there are not.
TEST(Attention, OnABlindLegOnePartOfThePictureAfterTheOtherIsSearched) {
  const LookingNorth drone{{gate_at({-4, 0, -1.5})}};
  Attention attention{{}};
  EXPECT_EQ(asked(attention, drone, kMissing, 120).parts, 10);
}

TEST(Attention, OfASlowCameraAllOfThePictureIsSearched) {
  LookingNorth drone{{gate_at({4, 0, -1.5})}};
  drone.interval = 0.2;
  Attention attention{{}};
  int careful = 0;
  for (int i = 0; i < 60; ++i) {
    const LookFor look =
        attention.next(drone.filter, i < 30 ? kMissing : kNow, 0.0, drone.picture());
    EXPECT_EQ(look.within, nullptr);
    EXPECT_TRUE(look.quick || look.gates == LookFor::Gates::kAll);
    careful += !look.quick;
  }
  EXPECT_EQ(careful, 30 + 30 / SightParams{}.careful_every);
}

// Wherever a gate of any size stands, some part holds it whole.
TEST(Attention, TheLostLookEverywhereInTurn) {
  LookingNorth drone{{gate_at({4, 0, -1.5})}};
  while (drone.filter.sigma(eskf::kP) < SightParams{}.lost_sigma) drone.wait(100);
  Attention attention{{}};
  std::vector<SearchWindow> parts;
  for (int i = 0; i < 4; ++i) {
    const LookFor look = attention.next(drone.filter, kMissing, 0.0, drone.picture());
    ASSERT_NE(look.within, nullptr);
    EXPECT_FALSE(look.within->for_one);
    parts.push_back(*look.within);
  }
  for (double size = 16.0; size < 150.0; size += 3.0)
    for (double left = 0.0; left + size < 315.0; left += 5.0)
      EXPECT_TRUE(std::any_of(parts.begin(), parts.end(),
                              [&](const SearchWindow& part) {
                                return part.left <= left && left + size <= part.right &&
                                       part.least_side <= size && size <= part.most_side;
                              }))
          << size << " px at " << left;
}

// Gates stand upright in the hall: in the picture they lean as the drone does.
TEST(Attention, APartIsSearchedForGatesThatStandUpright) {
  for (const double roll : {0.0, 0.35, -0.35}) {
    LookingNorth drone{{gate_at({4, 0, -1.5})}};
    for (int i = 0; i < 128; ++i)
      drone.filter.predict({{4.0 * roll, 0, 0}, {0, 0, -9.81}}, kTick, (drone.t += kTick));
    Attention attention{{.lost_sigma = 0.0}};
    const LookFor look = attention.next(drone.filter, kMissing, 0.0, drone.picture());
    ASSERT_NE(look.within, nullptr);
    EXPECT_LT(look.within->least_roll, -roll - 0.1);
    EXPECT_GT(look.within->most_roll, -roll + 0.1);
    EXPECT_LT(look.within->most_roll - look.within->least_roll, 0.9);
  }
}

}  // namespace
}  // namespace gatefly
