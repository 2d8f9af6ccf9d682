// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/way_round.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kWanted = 0.55;  // from a way's middle line to anything solid beside it [m]

/// Two gates 8 m apart, flown north, in a hall 20 m long, 6 m wide, 3 m high.
Track corridor() {
  Track track;
  track.gates = {{{4, 0, -1.5}, 0.0}, {{12, 0, -1.5}, 0.0}};
  track.room_center = {8, 0}, track.room_size = {20, 6}, track.ceiling = 3.0;
  return track;
}

/// A wall across the corridor at 8 m, up to `height`, that leaves a gap so wide at its east end.
MapObstacle wall_with_gap(double gap, double height = 3.0) {
  return {{8.0, -0.5 * gap}, {0.4, 6.0 - gap}, 0.0, height};
}

std::string refusal_of_way(const Track& track) {
  try {
    (void)plan_race(track, {});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "planned";
}

/// Beside any solid thing by so much or more, or above it or below it by 0.35 m, but through its own
/// two gates; the room included.
void expect_clear(const Path& path, const Track& track, int from_gate, int to_gate) {
  const double total = path.length();
  for (double s = 0.0; s <= total; s += 0.02) {
    const Vector2d p = path.at(s).position;
    const double height = -path.z_at(s);
    EXPECT_GT(((0.5 * track.room_size) - (p - track.room_center).cwiseAbs()).minCoeff(),
              kWanted - 0.02);
    EXPECT_GT(height, 0.3);
    EXPECT_LT(height, track.ceiling - 0.3);
    for (const MapObstacle& box : track.obstacles)
      if (height < box.height + 0.34) {
        const double c = std::cos(box.heading), si = std::sin(box.heading);
        const Vector2d d = p - box.center, own{c * d.x() + si * d.y(), c * d.y() - si * d.x()};
        EXPECT_GT((own.cwiseAbs() - 0.5 * box.size).cwiseMax(0.0).norm(), kWanted - 0.02) << s;
      }
    for (int g = 0; g < static_cast<int>(track.gates.size()); ++g) {
      const MapGate& gate = track.gates[static_cast<std::size_t>(g)];
      if ((g == from_gate && s < 0.9) || (g == to_gate && total - s < 0.9)) continue;
      if (std::abs(height + gate.p_EG.z()) > 0.5 * gate.side + 0.34) continue;
      const double c = std::cos(gate.yaw_EG), si = std::sin(gate.yaw_EG);
      const Vector2d d = p - gate.p_EG.head<2>(),
                     own{c * d.x() + si * d.y(), c * d.y() - si * d.x()};
      const Vector2d half{0.05, 0.5 * gate.side};
      EXPECT_GT((own.cwiseAbs() - half).cwiseMax(0.0).norm(), kWanted - 0.02) << s;
    }
  }
}

TEST(WayRound, GoesThroughAGapThatIsWideEnough) {
  Track track = corridor();
  track.obstacles = {wall_with_gap(1.5)};
  ASSERT_EQ(refusal_of_way(track), "planned");
  const Path path = plan_race(track, {}).legs.at(0);
  expect_clear(path, track, 0, 1);
  EXPECT_THAT(path.at(path.length()).position, IsNear(Vector2d{12, 0}, 1e-6));
  double east = 0.0;
  for (double s = 0.0; s < path.length(); s += 0.05) east = std::max(east, path.at(s).position.y());
  EXPECT_NEAR(east, 3.0 - 0.75, 0.25) << "in the middle of the gap";
}

// 2 x 0.55 m is what a drone of 0.4 m with 0.35 m on both sides needs.
TEST(WayRound, SaysWhichGapIsTooNarrowByHowMuch) {
  Track track = corridor();
  track.obstacles = {wall_with_gap(0.9)};
  EXPECT_THAT(refusal_of_way(track), HasSubstr("from gate 1 to gate 2"));
  EXPECT_THAT(refusal_of_way(track),
              HasSubstr("between obstacle 1 and a wall, is 0.90 m, 0.20 m too narrow"));
  track.obstacles = {{{8.0, -1.55}, {0.4, 2.9}, 0.0, 3.0}, {{8.0, 1.9}, {0.4, 2.2}, 0.0, 3.0}};
  EXPECT_THAT(refusal_of_way(track),
              HasSubstr("between obstacle 1 and obstacle 2, is 0.90 m, 0.20 m too narrow"));
  track.obstacles = {wall_with_gap(0.0, 2.5)};
  EXPECT_THAT(refusal_of_way(track),
              HasSubstr("between obstacle 1 and the ceiling, is 0.50 m, 0.20 m too narrow"));
  track.obstacles = {wall_with_gap(0.0, 3.0)};
  EXPECT_THAT(refusal_of_way(track), HasSubstr("obstacle 1 is in the way"));
  EXPECT_THAT(refusal_of_way(track), HasSubstr("leaves no gap"));
}

TEST(WayRound, GoesOverWhatReachesFromWallToWall) {
  Track track = corridor();
  track.obstacles = {wall_with_gap(0.0, 1.9)};
  ASSERT_EQ(refusal_of_way(track), "planned");
  const Path path = plan_race(track, {}).legs.at(0);
  expect_clear(path, track, 0, 1);
  EXPECT_NEAR(path.z_at(0.0), -1.5, 1e-9);
  EXPECT_NEAR(path.z_at(path.length()), -1.5, 1e-9);
  EXPECT_LT(path.z_at(path.nearest({8, 0}, 0, path.length())), -2.24);
}

TEST(WayRound, GoesBesideAnotherGateOrOverIt) {
  Track track = corridor();
  track.gates.insert(track.gates.begin() + 1, MapGate{{8, 0.2, -1.5}, kPi});  // flown the other way
  track.gates.push_back({{4, 2.0, -1.5}, 0.0});
  track.laps = 2;
  track.room_size.y() = 9.0;
  ASSERT_EQ(refusal_of_way(track), "planned");
  const RacePlan plan = plan_race(track, {});
  for (int i = 0; i < 4; ++i)
    expect_clear(plan.legs.at(static_cast<std::size_t>(i)), track, i, (i + 1) % 4);
}

// Side by side, flown there and back, with a wall 1.6 m behind them: no room for an arc of 0.7 m.
TEST(WayRound, StopsAndTurnsWhereNoTurnFits) {
  Track track;
  track.gates = {{{4, 0, -1.5}, 0.0}, {{4, 1.3, -2.0}, kPi}};
  track.room_center = {1.8, 0.65}, track.room_size = {7.6, 4.0}, track.ceiling = 3.5;
  ASSERT_EQ(refusal_of_way(track), "planned");
  const Path path = plan_race(track, {}).legs.at(0);
  expect_clear(path, track, 0, 1);
  ASSERT_GE(path.stops.size(), 1u);
  for (const Stop& stop : path.stops) {
    EXPECT_NEAR(wrap_angle(path.at(stop.s + 1e-3).heading - stop.heading), 0.0, 1e-6);
    EXPECT_NEAR(path.z_at(stop.s + 1e-3), stop.z, 0.01);
  }
  EXPECT_NEAR(path.z_at(path.length()), -2.0, 1e-9);
}

// From the upper opening back through the lower one, with the wall near behind: it goes down standing.
TEST(WayRound, GoesDownStandingBehindAStackedGate) {
  Track track;
  track.gates = {{{6, 0, -4.05}, 0.0, 2.7, 0.6}, {{6, 0, -1.35}, kPi, 2.7, 0.6}};
  track.room_center = {1.7, 0.0}, track.room_size = {11.4, 5.0}, track.ceiling = 8.0;
  ASSERT_EQ(refusal_of_way(track), "planned");
  const Path path = plan_race(track, {}).legs.at(0);
  ASSERT_GE(path.stops.size(), 1u);
  EXPECT_NEAR(path.z_at(0.0), -4.05, 1e-9);
  EXPECT_NEAR(path.z_at(path.length()), -1.35, 1e-9);
}

TEST(WayRound, TurnsOnThePadWhereTheFirstGateIsBehindIt) {
  Track track = corridor();
  track.room_size = {20, 2.6};
  track.start = {8, 0}, track.start_heading = kPi;
  track.gates = {{{12, 0, -1.5}, 0.0}};
  ASSERT_EQ(refusal_of_way(track), "planned");
  const Path path = plan_race(track, {}).start;
  ASSERT_EQ(path.stops.size(), 1u);
  EXPECT_EQ(path.stops[0].s, 0.0);
  EXPECT_NEAR(wrap_angle(path.stops[0].heading), 0.0, 1e-9);
}

}  // namespace
}  // namespace gatefly
