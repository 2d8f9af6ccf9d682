// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/solids.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

using Eigen::Vector2d;

/// The solids of a gate: frame and pole.
std::vector<MapSolid> of_gate(const Track& track, int number) {
  std::vector<MapSolid> found;
  for (const MapSolid& solid : solids_of(track))
    if (solid.kind == MapSolid::Kind::kGate && solid.number == number) found.push_back(solid);
  return found;
}

TEST(MapSolids, AGateIsAFrameBetweenTwoHeightsOnAPole) {
  Track track;
  track.gates = {{{5, 0, -1.5}, 0.0}};
  const auto gate = of_gate(track, 0);
  ASSERT_EQ(gate.size(), 2u);
  EXPECT_DOUBLE_EQ(gate[0].bottom, 1.0);
  EXPECT_DOUBLE_EQ(gate[0].top, 2.0);
  EXPECT_NEAR(gate[0].beside({4, 0}), 0.95, 1e-12) << "before it";
  EXPECT_NEAR(gate[0].beside({5, 1}), 0.5, 1e-12) << "beside it";
  EXPECT_DOUBLE_EQ(gate[0].above_or_below(2.3), 2.3 - 2.0);
  EXPECT_DOUBLE_EQ(gate[0].above_or_below(0.6), 1.0 - 0.6);
  EXPECT_LT(gate[0].above_or_below(1.5), 0.0);
  EXPECT_DOUBLE_EQ(gate[1].bottom, 0.0);
  EXPECT_DOUBLE_EQ(gate[1].top, 1.0);
  EXPECT_GT(gate[1].beside({5, 0.5}), 0.4) << "a pole is thin";
}

TEST(MapSolids, AGateOnTheFloorOrOnAnotherHasNoPole) {
  Track track;
  track.gates = {{{5, 0, -4.05}, kPi, 2.7, 0.6}, {{5, 0, -1.35}, 0.0, 2.7, 0.6}};
  EXPECT_EQ(of_gate(track, 0).size(), 1u);
  EXPECT_EQ(of_gate(track, 1).size(), 1u);
}

TEST(MapSolids, TheWidthOfAGapIsBetweenTheNearestCorners) {
  MapSolid one{.footprint = {{0, 0}, {2, 1}, 0.0}}, other = one;
  other.footprint.center = {0, 2};
  EXPECT_NEAR(gap_between(one, other, {}).width, 1.0, 1e-12);
  EXPECT_NEAR(gap_between(one, other, {}).needed, 1.1, 1e-12);
  other.footprint.heading = 45 * kDegree;  // its corner is nearest now
  EXPECT_NEAR(gap_between(one, other, {}).width, 1.5 - 0.5 * (2 + 1) * std::sqrt(0.5), 1e-12);
  other.bottom = 2.0, one.top = 1.5;
  EXPECT_NEAR(gap_between(one, other, {}).width, 0.5, 1e-12) << "in height";
  EXPECT_NEAR(gap_between(one, other, {}).needed, 0.7, 1e-12);
}

TEST(MapSolids, NearestOfAWayIsWhatIsNotWellAboveOrBelow) {
  Track track;
  track.gates = {{{0, 0, -1.5}, 0.0}, {{10, 0, -1.5}, 0.0}};
  track.obstacles = {{{5, 0.8}, {1, 1}, 0.0, 1.1}, {{5, 1.1}, {1, 1}, 0.0, 1.2}};
  Path path;
  (void)path.segments.push_back({{0, 0}, 0.0, 0.0, 10.0});
  (void)path.levels.push_back({0.0, -1.5});
  const auto nearest = [&](int from, int to) {
    const auto solids = solids_of(track);
    const Nearest found = nearest_solid(solids, {}, path, from, to, -1e9);
    return std::pair{found.solid->name(), found.distance};
  };
  const auto [name, distance] = nearest(0, 1);
  EXPECT_EQ(name, "obstacle 2") << "the first ends 0.4 m below";
  EXPECT_NEAR(distance, 0.6, 1e-9);
  EXPECT_EQ(nearest(-1, 1).first, "gate 1") << "not its own end: it is in the way";
  track.gates[0].p_EG.z() = -2.4;  // its frame begins 0.4 m above the way
  EXPECT_LT(nearest(-1, 1).second, 0.0) << "its pole stands there still";
}

}  // namespace
}  // namespace gatefly
