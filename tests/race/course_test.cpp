// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/course.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Track two_gates() {
  Track track;
  track.gates = {{{4, 0, -1.5}, 0.0}, {{2, 4, -1.5}, kPi}};
  track.laps = 2;
  return track;
}

/// Navigation state of a drone there; the gate's frame follows from the course's target.
NavigationState at(const Course& course, const Vector3d& p_EB) {
  NavigationState now;
  now.p_EB = p_EB;
  now.p_GB = rotation_z(-course.gate().yaw_EG) * (p_EB - course.gate().p_EG);
  return now;
}

/// Flies the planned way to the target and `past` metres through it, in steps of 5 cm. True as soon
/// as another gate is the target.
bool fly_through(Course& course, const Phase& phase, double past = 0.5) {
  const Path path = course.path();
  for (double s = course.progress(); s < path.length() + past; s += 0.05) {
    const PathPoint here = path.at(s);
    if (course.follow(at(course, {here.position.x(), here.position.y(), -1.5}), phase)) return true;
  }
  return false;
}

TEST(Course, PassesItsGatesInOrderLapForLap) {
  Course course{two_gates(), {}};
  for (int passed = 0; passed < 4; ++passed) {
    EXPECT_EQ(course.passed(), passed);
    EXPECT_EQ(course.target(), passed % 2);
    EXPECT_FALSE(course.finished());
    EXPECT_EQ(fly_through(course, Straight{}), passed < 3) << "the last one leads nowhere";
  }
  EXPECT_TRUE(course.finished());
  EXPECT_FALSE(fly_through(course, Straight{}));
  EXPECT_EQ(course.passed(), 4);
}

TEST(Course, BehindTheLastGateItFliesOnBeforeItIsDone) {
  Course course{two_gates(), {}};
  for (int gate = 0; gate < 4; ++gate) (void)fly_through(course, Straight{}, 0.2);
  ASSERT_TRUE(course.finished());
  EXPECT_FALSE(course.ran_out()) << "just behind it";
  const PathPoint on = course.path().at(1.05);
  for (double s = 0.0; s < 1.05; s += 0.05) {
    const PathPoint here = course.path().at(s);
    (void)course.follow(at(course, {here.position.x(), here.position.y(), -1.5}), Straight{});
  }
  (void)course.follow(at(course, {on.position.x(), on.position.y(), -1.5}), Straight{});
  EXPECT_TRUE(course.ran_out());
  EXPECT_EQ(course.passed(), 4) << "and passes no other gate";
}

TEST(Course, WhereNoWayLeadsOnBehindTheLastGateItIsDoneThere) {
  Track track = two_gates();
  track.laps = 1;
  Course course{track, {}};
  for (int gate = 0; gate < 2; ++gate) (void)fly_through(course, Straight{}, 0.2);
  EXPECT_TRUE(course.finished() && course.ran_out());
}

TEST(Course, ProgressFollowsTheDroneAndNeverLeapsToAnotherPart) {
  Course course{two_gates(), {}};
  const Path path = course.path();
  const PathPoint end = path.at(path.length() - 0.5);
  (void)course.follow(at(course, {end.position.x(), end.position.y(), -1.5}), Straight{});
  EXPECT_LE(course.progress(), 0.8 + 1e-9);
  EXPECT_NEAR(course.to_go(), path.length() - course.progress(), 1e-12);
}

TEST(Course, NothingIsPassedOnTheGround) {
  Course course{two_gates(), {}};
  EXPECT_FALSE(fly_through(course, OnGround{}));
  EXPECT_EQ(course.passed(), 0);
}

// While searching only what goes through the opening counts.
TEST(Course, ASearchPassesAGateOnlyThroughItsOpening) {
  for (const double aside : {0.0, 0.8}) {
    Course course{two_gates(), {}};
    const double before = course.path().length() - 1.0;
    for (double s = 0.0; s < before; s += 0.05) {
      const PathPoint here = course.path().at(s);
      (void)course.follow(at(course, {here.position.x(), here.position.y(), -1.5}), Straight{});
    }
    bool passed = false;
    for (double x = 3.5; x < 4.4 && !passed; x += 0.02)
      passed = course.follow(at(course, {x, aside, -1.5}), Search{});
    EXPECT_EQ(passed, aside == 0.0);
    EXPECT_EQ(course.target(), aside == 0.0 ? 1 : 0);
  }
}

TEST(Course, AfterASearchTheWayLeadsStraightAlongTheAxisAndEndsInTheGate) {
  Course course{two_gates(), {}};
  course.approach_straight(at(course, {1.8, 0.1, -1.4}));
  EXPECT_NEAR(course.to_go(), 2.2, 1e-9) << "from where it is";
  const PathPoint end = course.path().at(course.path().length());
  EXPECT_NEAR((end.position - Eigen::Vector2d{4, 0}).norm(), 0.0, 1e-9);
  EXPECT_EQ(end.heading, 0.0);
  EXPECT_EQ(course.path().z_at(1.0), -1.5);
  EXPECT_TRUE(fly_through(course, Straight{}));
  EXPECT_EQ(course.target(), 1) << "and then the leg's own way again";
  EXPECT_GT(course.path().segments.size(), 1U);
}

TEST(Course, RefusesATrackThatCannotBeFlown) {
  EXPECT_THROW((Course{Track{}, {}}), std::invalid_argument);
}

// Gates side by side with a wall behind them: the way from one to the other has stops.
TEST(Course, GoesOnFromAStopOnlyWhenItStandsAndHasTurned) {
  Track track;
  track.gates = {{{4, 0, -1.5}, 0.0}, {{4, 1.3, -1.5}, kPi}};
  track.room_center = {1.8, 0.65}, track.room_size = {7.6, 4.0}, track.ceiling = 3.5;
  Course course{track, {}};
  ASSERT_TRUE(fly_through(course, Straight{}));
  ASSERT_NE(course.stop(), nullptr);
  const Stop stop = *course.stop();
  const Vector2d place = course.path().at(stop.s).position;
  NavigationState now = at(course, {4.2, 0, -1.5});
  const auto follow = [&](const Vector2d& p) {
    now.p_EB.head<2>() = p;
    for (int i = 0; i < 10; ++i) (void)course.follow(now, Straight{});
  };
  follow(place);
  EXPECT_NEAR(course.progress(), stop.s, 1e-9);
  EXPECT_EQ(course.ahead(1.0), stop.s);
  follow(course.path().at(stop.s + 0.5).position);
  EXPECT_LE(course.progress(), stop.s) << "pushed on, it has not turned";
  now.attitude.yaw = stop.heading, now.v_E = {0.6, 0, 0};
  follow(place);
  EXPECT_LE(course.progress(), stop.s) << "turned, it still moves";
  now.v_E.setZero();
  follow(place);
  EXPECT_GT(course.progress(), stop.s);
  EXPECT_TRUE(course.stop() == nullptr || course.stop()->s > stop.s);
}

}  // namespace
}  // namespace gatefly
