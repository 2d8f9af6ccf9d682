// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/race/course.hpp"
#include "gatefly/race/path.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

Track oval() {
  Track track;
  track.gates = {{{4, 0, -1.5}, 0.0}, {{2, 4, -1.5}, kPi}};
  track.laps = 2;
  return track;
}

void expect_leg(const Path& leg, const Vector2d& from, double from_heading, const Vector2d& to,
                double to_heading) {
  EXPECT_THAT(leg.at(0).position, IsNear(from, 1e-6));
  EXPECT_NEAR(wrap_angle(leg.at(0).heading - from_heading), 0, 1e-6);
  EXPECT_THAT(leg.at(leg.length()).position, IsNear(to, 1e-6));
  EXPECT_NEAR(wrap_angle(leg.at(leg.length()).heading - to_heading), 0, 1e-6);
  EXPECT_EQ(leg.at(leg.length()).curvature, 0.0) << "straight through the gate";
  for (double s = 0; s < leg.length(); s += 0.02)
    EXPECT_LT((leg.at(s).position - leg.at(s + 1e-6).position).norm(), 2e-6) << "a jump at " << s;
}

// Least distance from a leg to an upright box, on the floor plan.
double room_to(const Path& leg, const MapObstacle& box) {
  double least = 1e9;
  for (double s = 0; s <= leg.length(); s += 0.02) {
    const Vector2d d = leg.at(s).position - box.center;
    const double c = std::cos(box.heading), si = std::sin(box.heading);
    const Vector2d local{c * d.x() + si * d.y(), -si * d.x() + c * d.y()};
    least = std::min(least, (local.cwiseAbs() - 0.5 * box.size).cwiseMax(0.0).norm());
  }
  return least;
}

std::string refusal(const Track& track, const PlanParams& params = {}) {
  try {
    (void)plan_race(track, params);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "planned";
}

TEST(Plan, LegsLeadThroughTheGatesInTheirDirection) {
  const Track track = oval();
  const RacePlan plan = plan_race(track, {});
  ASSERT_EQ(plan.legs.size(), 2u);
  expect_leg(plan.start, {0, 0}, 0, {4, 0}, 0);
  expect_leg(plan.legs[0], {4, 0}, 0, {2, 4}, kPi);
  expect_leg(plan.legs[1], {2, 4}, kPi, {4, 0}, 0);
}

TEST(Plan, ASingleLapEndsAtItsLastGate) {
  Track track = oval();
  track.laps = 1;
  EXPECT_EQ(plan_race(track, {}).legs.size(), 1u);
}

TEST(Plan, RandomPairsOfGatesAreReachedOrRefusedWithAReason) {
  int planned = 0;
  for_all(60, [&](Rng& rng) {
    Track track;
    const double yaw = rng.uniform(-1, 1);
    track.gates = {{{5, 0, -1.5}, 0.0},
                   {{5 + rng.uniform(3, 6), rng.uniform(-5, 5), rng.uniform(-2, -1.2)}, yaw}};
    track.laps = 1;
    try {
      const RacePlan plan = plan_race(track, {});
      ++planned;
      expect_leg(plan.legs[0], {5, 0}, 0, track.gates[1].p_EG.head<2>(), yaw);
      EXPECT_NEAR(plan.legs[0].z_at(plan.legs[0].length()), track.gates[1].p_EG.z(), 1e-9);
      for (const Segment& segment : plan.legs[0].segments)
        EXPECT_LE(std::abs(segment.curvature), 1 / PlanParams{}.min_radius + 1e-9);
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr("gate 2"));
    }
  });
  EXPECT_GT(planned, 40);
}

TEST(Plan, ATurnedAndShiftedCourseHasTheTurnedAndShiftedPlan) {
  const Track track = oval();
  const RacePlan plan = plan_race(track, {});
  const double turn = 0.7;
  const Vector2d shift{30, -20};
  const auto moved = [&](const Vector2d& p) {
    return Vector2d{shift + Vector2d{std::cos(turn) * p.x() - std::sin(turn) * p.y(),
                                     std::sin(turn) * p.x() + std::cos(turn) * p.y()}};
  };
  Track other = track;
  other.start = moved(track.start), other.start_heading += turn;
  for (auto& gate : other.gates) {
    const Vector2d p = moved(gate.p_EG.head<2>());
    gate.p_EG = {p.x(), p.y(), gate.p_EG.z()}, gate.yaw_EG += turn;
  }
  const RacePlan again = plan_race(other, {});
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_NEAR(again.legs[i].length(), plan.legs[i].length(), 1e-6);
    for (double s = 0; s < plan.legs[i].length(); s += 0.1)
      EXPECT_THAT(again.legs[i].at(s).position, IsNear(moved(plan.legs[i].at(s).position), 1e-6));
  }
}

TEST(Plan, KeepsItsClearanceToObstaclesAndFliesOverLowOnes) {
  const PlanParams params;
  Track track = oval();
  track.obstacles = {{{6.5, 1.8}, {0.3, 0.3}, 0.4, 2.2},
                     {{3, 2}, {1, 1}, 0.0, 2.0},
                     {{0.2, 2.2}, {0.3, 0.3}, 0.0, 2.2}};
  const RacePlan plan = plan_race(track, params);
  for (const Path* leg : {&plan.start, &plan.legs[0], &plan.legs[1]})
    for (const MapObstacle& obstacle : track.obstacles)
      EXPECT_GT(room_to(*leg, obstacle), params.clearance + params.body_radius - 0.01);

  Track low = oval();
  low.obstacles = {{{2, 0}, {0.5, 0.5}, 0.0, 0.5}};  // a low table on the way to gate 1
  EXPECT_EQ(refusal(low), "planned");
}

TEST(Plan, StaysInTheRoomOrSaysThatTheWallIsInTheWay) {
  Track track = oval();
  track.room_center = {3, 2}, track.room_size = {11, 10};
  const RacePlan plan = plan_race(track, {});
  for (const Path& leg : plan.legs)
    for (double s = 0; s < leg.length(); s += 0.05) {
      const Vector2d out =
          (leg.at(s).position - track.room_center).cwiseAbs() - 0.5 * track.room_size;
      EXPECT_LT(out.maxCoeff(), 0.0);
    }
  track.room_center = {4, 2}, track.room_size = {1, 5};  // gates with their backs to the wall
  EXPECT_THAT(refusal(track), HasSubstr("wall"));
}

TEST(Plan, ImpossibleCoursesAreRefusedWithTheReason) {
  EXPECT_THAT(refusal(Track{}), HasSubstr("no gates"));

  Track small = oval();
  small.gates[1].side = 0.4;
  EXPECT_THAT(refusal(small), HasSubstr("gate 2 is too small"));

  Track low = oval();
  low.gates[0].p_EG.z() = -0.4;
  EXPECT_THAT(refusal(low), HasSubstr("gate 1 is too low"));

  Track high = oval();
  high.ceiling = 1.8;
  EXPECT_THAT(refusal(high), HasSubstr("too high"));

  Track blocked = oval();
  blocked.obstacles = {{{4, 0}, {0.2, 0.2}, 0, 2.0}};
  EXPECT_THAT(refusal(blocked), HasSubstr("obstacle 1 stands in the opening of gate 1"));

  Track walled = oval();
  walled.room_size = {20, 50}, walled.ceiling = 3.0;
  walled.obstacles = {{{1.2, 0}, {0.3, 50}, 0, 3.0}};  // a wall across, between the pad and gate 1
  EXPECT_THAT(refusal(walled), HasSubstr("from the start to gate 1"));
  EXPECT_THAT(refusal(walled), HasSubstr("obstacle 1 is in the way"));

  Track boxed = oval();
  boxed.obstacles = {{boxed.start, {1.0, 1.0}, 0, 1.0}};
  EXPECT_THAT(refusal(boxed), HasSubstr("the start is in obstacle 1"));

  Track none = oval();
  none.laps = 0;
  EXPECT_THAT(refusal(none), HasSubstr("laps"));
}

TEST(Plan, AGateMayStandOnTheFloor) {
  Track track;
  track.gates = {{{6, 0, -1.35}, 0.0, 2.7, 0.6}};
  EXPECT_EQ(refusal(track), "planned");
  track.gates[0].p_EG.z() = -1.3;
  EXPECT_THAT(refusal(track), HasSubstr("gate 1 is too low"));
}

// The upper opening, then the lower one back, as at the AI Grand Prix.
TEST(Plan, GatesOneAboveTheOtherAreFlownThereAndBack) {
  Track track;
  track.gates = {{{6, 0, -4.05}, 0.0, 2.7, 0.6}, {{6, 0, -1.35}, kPi, 2.7, 0.6}};
  ASSERT_EQ(refusal(track), "planned");
  const RacePlan plan = plan_race(track, {});
  expect_leg(plan.legs[0], {6, 0}, 0, {6, 0}, kPi);
  EXPECT_TRUE(plan.legs[0].stops.empty()) << "there is room for a hairpin";
  EXPECT_EQ(plan.legs[0].z_at(0.0), -4.05);
  EXPECT_NEAR(plan.legs[0].z_at(plan.legs[0].length() - 1.0), -1.35, 1e-9);
  for (double s = 0.0; s < plan.legs[0].length(); s += 0.1)
    EXPECT_LE(plan.legs[0].z_at(s), plan.legs[0].z_at(s + 0.1)) << "down all the way";
}

// A pillar 3 m before the gate: from the gate's plane to it there is 3 m less what the body needs.
/// Eight gates on a circle, flown round to the right.
Track ring(double radius) {
  Track track;
  for (int i = 0; i < 8; ++i) {
    const double angle = i * kPi / 4;
    track.gates.push_back({{radius * std::cos(angle), radius * std::sin(angle), -1.8},
                           wrap_angle(angle + kPi / 2),
                           2.7,
                           0.6});
  }
  track.start = track.gates[0].p_EG.head<2>() - Vector2d{0, 6};
  track.start_heading = kPi / 2;
  track.laps = 2;
  return track;
}

TEST(Plan, AFastDroneIsLedThroughARingInWideArcsAndNotFromStraightToStraight) {
  const PlanParams fast{.speed = 6.0, .max_lateral = 7.0};
  const RacePlan plan = plan_race(ring(14.0), fast);
  for (const Path& leg : plan.legs)
    for (const Segment& segment : leg.segments) EXPECT_NEAR(speed_on(segment, fast), 6.0, 1e-9);
}

TEST(Plan, AGateIsPassedNoFasterThanTheTurnBehindItAllows) {
  const PlanParams params{.speed = 5.0};
  const RacePlan plan = plan_race(oval(), params);
  ASSERT_EQ(plan.gate_speed.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    double s = 0.0, least = params.speed;
    for (const Segment& segment : plan.legs[i].segments) {
      // Energy: what braking takes off between gate and turn.
      const double limit = speed_on(segment, params);
      if (segment.curvature != 0.0) {
        EXPECT_LE(plan.gate_speed[i],
                  std::sqrt(limit * limit + 2 * params.braking.on_the_way * s) + 1e-9);
        least = std::min(least, limit);
      }
      s += segment.length;
    }
    EXPECT_GE(plan.gate_speed[i], least - 1e-9) << "nor slower than the tightest turn";
  }
}

TEST(Plan, AGentleTurnIsAWayToComeOntoTheAxisAndATightOneIsNot) {
  Path path;
  (void)path.segments.push_back({{0, 0}, 0.0, 1.0 / 8, 2.0});
  (void)path.segments.push_back({{0, 0}, 0.0, 0.0, 1.5});
  EXPECT_DOUBLE_EQ(way_to_settle(path, 2.0, 3.2), 3.5) << "half a m/s² of 3.2";
  EXPECT_DOUBLE_EQ(way_to_settle(path, std::sqrt(3.2 * 8), 3.2), 1.5)
      << "all that an arc may ask for";
  path.segments[0].length = 20.0;
  EXPECT_DOUBLE_EQ(way_to_settle(path, 2.0, 3.2), 1.5 + 0.6 * 8) << "as far as the gate is in view";
}

// A post 1.2 m beside the way, 5 m along it: the body's outline passes it at a metre.
TEST(Plan, KnowsTheRoomBesideItsWay) {
  Track track;
  track.gates = {{{10, 0, -1.5}, 0.0}};
  track.room_size = {40, 40}, track.laps = 1;
  track.obstacles = {{.center = {5, 1.3}, .size = {0.2, 0.2}, .heading = 0.0, .height = 3.0}};
  const PlanParams params;
  const RacePlan plan = plan_race(track, params);
  ASSERT_EQ(plan.room_beside.size(), 1u);
  const std::vector<double>& room = plan.room_beside[0];
  ASSERT_EQ(room.size(), static_cast<std::size_t>(std::ceil(plan.start.length() / kRoomStep)));
  const auto least =
      std::min_element(room.begin(), room.end() - 4);  // beyond is the gate's own frame
  EXPECT_NEAR(*least, 1.2 - params.body_radius, 0.02);
  EXPECT_NEAR(static_cast<double>(least - room.begin()) * kRoomStep, 5.0, 0.6);
  Course course{track, params};
  EXPECT_GT(course.room_beside(2.0), 2.5) << "not there yet";
  EXPECT_NEAR(course.room_beside(6.0), *least, 1e-9);

  // After a search a straight approach takes the place of the leg, and ends where it ends.
  NavigationState now;
  now.p_GB = {-7.0, 0.0, 0.0};
  course.approach_straight(now);
  EXPECT_NEAR(course.room_beside(3.0), *least, 1e-9) << "from 7 m before the gate it lies ahead";
  now.p_GB = {-4.0, 0.0, 0.0};
  course.approach_straight(now);
  EXPECT_GT(course.room_beside(1.0), *least + 0.1) << "from 4 m it lies behind";
}

// A wall with a gap of 1 m: 2 x 0.55 m are wanted, 2 x 0.47 m are flown where nothing else is there.
TEST(Plan, FliesANarrowGapWhereNoOtherWayIs) {
  Track track;
  track.gates = {{{6, 0, -1.5}, 0.0}};
  track.room_center = {3, 0}, track.room_size = {16, 6}, track.laps = 1, track.ceiling = 3.0;
  track.obstacles = {{.center = {3, -1.75}, .size = {0.4, 2.5}, .heading = 0.0, .height = 3.0},
                     {.center = {3, 1.75}, .size = {0.4, 2.5}, .heading = 0.0, .height = 3.0}};
  PlanParams params;
  const RacePlan plan = plan_race(track, params);
  EXPECT_GE(*std::min_element(plan.room_beside[0].begin(), plan.room_beside[0].end()),
            params.least_clearance - 0.01);
  params.least_clearance = params.clearance;
  EXPECT_THROW((void)plan_race(track, params), std::invalid_argument) << "when told to keep it";
}

// A stop 1.3 m behind a gate: passed as fast as 0.6 m/s² brake until there.
TEST(Plan, AGateBeforeAStopIsPassedSlowly) {
  Track track;
  track.gates = {{{0, 0, -0.8}, 0.0}, {{0, 0, -2.0}, 0.0}};
  track.room_size = {9, 5}, track.ceiling = 4.0, track.start = {-3.5, 0};
  const PlanParams params;
  const RacePlan plan = plan_race(track, params);
  ASSERT_FALSE(plan.legs[0].stops.empty()) << "no room for an arc";
  EXPECT_LE(plan.gate_speed[0],
            std::sqrt(2.0 * params.braking.to_a_stop * plan.legs[0].stops[0].s) + 1e-9);
  EXPECT_LT(plan.gate_speed[0], params.speed);
}

TEST(Plan, KnowsTheRoomBeforeAGate) {
  Track track;
  track.gates = {{{12, 0, -1.5}, 0.0}};
  EXPECT_GT(plan_race(track, {}).room_before.at(0), 7.9) << "nothing stands there";
  track.obstacles = {{{9, 0}, {0.2, 0.2}, 0.0, 3.0}};
  const PlanParams params;
  EXPECT_NEAR(plan_race(track, params).room_before.at(0),
              3.0 - 0.1 - params.clearance - params.body_radius, 0.15);
}

// A leg that climbs passes above a gate between its ends where there is room, else round it.
TEST(Plan, AClimbingLegPassesAboveAGateAndRoundAHighOne) {
  const auto with_gate_at = [](double height) {
    Track track;
    track.gates = {{{5, 0, -1.5}, 0.0}, {{15, 0, -4.5}, 0.0}, {{10, 0, -height}, kPi}};
    track.laps = 1;
    return track;
  };
  ASSERT_EQ(refusal(with_gate_at(1.2)), "planned");
  const Path above = plan_race(with_gate_at(1.2), {}).legs[0];
  EXPECT_NEAR(above.length(), 10.0, 1e-6) << "straight on";
  EXPECT_LT(above.z_at(5.0), -1.7 - 0.35);
  const double in_the_way = -above.z_at(5.0);
  const Path round = plan_race(with_gate_at(in_the_way), {}).legs[0];
  for (double s = 0.0; s <= round.length(); s += 0.05) {
    const Vector2d off = (round.at(s).position - Vector2d{10, 0}).cwiseAbs();
    const bool beside = off.x() > 0.58 || off.y() > 0.5 + 0.53;
    EXPECT_TRUE(beside || std::abs(-round.z_at(s) - in_the_way) > 0.5 + 0.33) << s;
  }
}

// As long as the way there, there must be a way round again.
TEST(Plan, ASingleGateCanBeFlownTwice) {
  Track track;
  track.gates = {{{4, 0, -1.5}, 0.0}};
  track.laps = 2;
  ASSERT_EQ(refusal(track), "planned");
  const RacePlan plan = plan_race(track, {});
  expect_leg(plan.legs[0], {4, 0}, 0, {4, 0}, 0);
  EXPECT_GT(plan.legs[0].length(), 5.0);
}

}  // namespace
}  // namespace gatefly
