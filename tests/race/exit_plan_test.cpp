// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/paper/exit_plan.hpp"

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/race/course.hpp"

namespace gatefly {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Two lanes 3 m apart, half circles of 1.5 m to the right at both ends: an oval that closes.
Track oval_by_exits() {
  Track track;
  const GateExit exit{.run = 0.5, .angle = kPi, .radius = 1.5};
  track.gates = {{.p_EG = {3.5, 0, -1.5}, .yaw_EG = 0.0, .exit = exit},
                 {.p_EG = {0, 3, -1.4}, .yaw_EG = kPi, .exit = exit}};
  track.laps = 2;
  return track;
}

std::string refused(const Track& track) {
  try {
    (void)plan_from_exits(track);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ExitPlan, RunsOutTurnsAndEndsOnTheAxisOfTheNextGate) {
  const RacePlan plan = plan_from_exits(oval_by_exits());
  ASSERT_EQ(plan.legs.size(), 2u);
  EXPECT_NEAR(plan.start.length(), 3.5, 1e-12);
  const Path& leg = plan.legs[0];
  EXPECT_NEAR(leg.length(), 0.5 + kPi * 1.5 + 4.0, 1e-12);
  EXPECT_TRUE(leg.at(0.5).position.isApprox(Vector2d(4.0, 0.0)));
  EXPECT_TRUE(leg.at(0.5 + 0.5 * kPi * 1.5).position.isApprox(Vector2d(5.5, 1.5)));
  EXPECT_TRUE(leg.at(leg.length()).position.isApprox(Vector2d(0.0, 3.0)));
  EXPECT_EQ(leg.z_at(0.0), -1.5);
  EXPECT_NEAR(leg.z_at(leg.length()), -1.4, 1e-12);
}

TEST(ExitPlan, ALeftTurnGoesLeft) {
  Track track = oval_by_exits();
  track.gates[0].exit->angle = -kPi;
  const RacePlan plan = plan_from_exits(track);
  EXPECT_LT(plan.legs[0].at(2.0).position.y(), 0.0);
}

TEST(ExitPlan, SaysWhichExitIsMissingOrWrong) {
  Track track = oval_by_exits();
  track.gates[1].exit.reset();
  EXPECT_THAT(refused(track), ::testing::HasSubstr("gate 2 has no exit"));
  track.laps = 1;
  EXPECT_EQ(refused(track), "") << "the last gate of a single lap leads nowhere";
  track = oval_by_exits();
  track.gates[0].exit->angle = 0.75 * kPi;
  EXPECT_THAT(refused(track), ::testing::HasSubstr("the exit of gate 1 turns by -45°"));
  track = oval_by_exits();
  track.gates[1].p_EG.x() = 8.0;
  EXPECT_THAT(refused(track), ::testing::HasSubstr("the arc behind gate 1, before gate 2, is not"));
  track = oval_by_exits();
  track.gates = {track.gates[0]};
  track.gates[0].exit->angle = 2 * kPi;
  EXPECT_THAT(refused(track), ::testing::HasSubstr("full circle"));
  track.gates[0].exit->angle = 355.0 * kDegree;
  EXPECT_THAT(refused(track), ::testing::HasSubstr("full circle"));
  EXPECT_NE(refused(Track{}), "");
}

NavigationState navigated_to(const Course& course, const Vector3d& p_EB) {
  NavigationState now;
  now.p_EB = p_EB;
  now.p_GB = rotation_z(-course.gate().yaw_EG) * (p_EB - course.gate().p_EG);
  return now;
}

// The flown rule is a window of 5 cm around the turn point, which a jump can miss.
TEST(CourseByExits, AGateIsPassedAtItsTurnPointOrAnywhereBehindIt) {
  for (const double x : {4.0, 4.7}) {
    Course course = Course::by_exits(oval_by_exits());
    EXPECT_FALSE(course.follow(navigated_to(course, {3.95, 0.1, -1.5}), Straight{}));
    EXPECT_FALSE(course.before_approach());
    EXPECT_TRUE(course.follow(navigated_to(course, {x, 0.1, -1.5}), Straight{}));
    EXPECT_EQ(course.target(), 1);
    EXPECT_TRUE(course.before_approach());
  }
}

// Gates in a row: there is no turn, and nothing to wait for.
TEST(CourseByExits, AnExitThatHardlyTurnsGoesStraightOn) {
  Track track = oval_by_exits();
  track.gates[0].exit->angle = 2.0 * kDegree;
  track.gates[1].p_EG = {9.0, 0.1, -1.5};
  track.gates[1].yaw_EG = -2.0 * kDegree;
  track.laps = 1;
  Course course = Course::by_exits(track);
  ASSERT_TRUE(course.follow(navigated_to(course, {4.0, 0, -1.5}), Straight{}));
  EXPECT_FALSE(course.before_approach());
}

TEST(CourseByExits, NothingIsPassedInATurnOrBeforeTheApproachHasBegun) {
  Course course = Course::by_exits(oval_by_exits());
  ASSERT_TRUE(course.follow(navigated_to(course, {4.0, 0, -1.5}), Straight{}));
  EXPECT_FALSE(course.follow(navigated_to(course, {-1.0, 3.0, -1.4}), Turn{}));
  EXPECT_FALSE(course.follow(navigated_to(course, {-1.0, 3.0, -1.4}), Straight{}));
  EXPECT_TRUE(course.turn_end().isApprox(Vector2d(4.0, 3.0)));
  EXPECT_NEAR(*course.approach_length(), 4.0, 1e-12);
  course.begin_approach();
  EXPECT_TRUE(course.follow(navigated_to(course, {-1.0, 3.0, -1.4}), Straight{}));
}

}  // namespace
}  // namespace gatefly
