// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/paper/paper_guidance.hpp"

#include <cmath>
#include <utility>
#include <variant>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;

constexpr double kPaperDt = 1.0 / 512, kFilterDrag = -0.50;
const PaperControlParams kParams;

GuidanceParams flown() {
  GuidanceParams params;
  params.lateral = {.kp = 0.50, .kd = 0.20};
  return params;
}

Course two_lanes() {
  Track track;
  const GateExit exit{.run = 0.5, .angle = kPi, .radius = 1.5};
  track.gates = {{.p_EG = {6, 0, -1.5}, .yaw_EG = 0.0, .exit = exit},
                 {.p_EG = {0, 3, -1.5}, .yaw_EG = kPi, .exit = exit}};
  track.laps = 2;
  return Course::by_exits(track);
}

NavigationState paper_state_at(const Vector3d& p_GB, const Vector3d& v) {
  NavigationState now;
  now.time = 10.0, now.dt = kPaperDt;
  now.p_GB = p_GB, now.p_EB = p_GB + Vector3d{6, 0, -1.5};
  now.v_E = now.v_B = now.v_GB = v;
  return now;
}

PaperGuidance guidance() { return {kParams, flown(), kFilterDrag, 512.0}; }

// Li18 Eq. (22), with the gains of March 2018.
TEST(PaperGuidance, OnAStraightThePitchIsFixedAndThePdBringsItToTheAxis) {
  PaperGuidance g = guidance();
  const Course course = two_lanes();
  Phase phase = Straight{};
  for (const double speed : {0.0, 1.5, 4.0}) {
    const AttitudeCommand c =
        g.command(phase, paper_state_at({-3, 0.3, 0}, {speed, 0.1, 0}), course);
    EXPECT_NEAR(c.roll, -0.50 * 0.3 - 0.20 * 0.1, 1e-12);
    EXPECT_EQ(c.pitch, -5.0 * kDegree) << "whatever the speed";
    EXPECT_EQ(c.yaw, 0.0);
  }
  EXPECT_NEAR(g.command(phase, paper_state_at({-3, 2.0, 0}, {1.5, 0, 0}), course).roll,
              -25.0 * kDegree, 1e-12);
}

// Eq. (29): nothing that is measured changes what is commanded.
TEST(PaperGuidance, ATurnIsOpenLoop) {
  Course course = two_lanes();
  ASSERT_TRUE(course.follow(paper_state_at({0.6, 0, 0}, {1.6, 0, 0}), Straight{}));
  PaperGuidance g = guidance(), other = guidance();
  Phase phase = Turn{{.yaw = 0.0, .v_F = {1.6, 0, 0}}}, same = phase;
  double yaw = 0.0;
  for (int i = 0; i < 1024; ++i) {
    const AttitudeCommand a = g.command(phase, paper_state_at({0.6, 0, 0}, {1.6, 0, 0}), course);
    const AttitudeCommand b = other.command(same, paper_state_at({2, 3, 0}, {0.3, 1, 0}), course);
    EXPECT_EQ(a.roll, b.roll);
    EXPECT_EQ(a.yaw, b.yaw);
    EXPECT_GT(a.roll, 0.0) << "right";
    EXPECT_EQ(a.yaw_rate, 0.0);
    yaw = a.yaw;
  }
  // ψ_c = ∫ v / r dt, the speed near what 5 degrees hold against drag
  const double v = std::get<Turn>(phase).arc.v_F.x();
  EXPECT_NEAR(v, 1.6, 0.1);
  EXPECT_NEAR(yaw, 2.0 * 1.6 / 1.5, 0.08);
}

TEST(PaperGuidance, ATurnEndsThreeDegreesBeforeItsHeading) {
  Course course = two_lanes();
  ASSERT_TRUE(course.follow(paper_state_at({0.6, 0, 0}, {1.6, 0, 0}), Straight{}));
  const PaperGuidance g = guidance();
  NavigationState now = paper_state_at({0.6, 0, 0}, {1.6, 0, 0});
  for (const auto& [yaw_deg, turns] :
       {std::pair{0.0, true}, {176.9, true}, {177.1, false}, {-177.1, false}, {-176.9, true}}) {
    now.attitude.yaw = yaw_deg * kDegree;
    EXPECT_EQ(g.turn_ahead(now, course), turns) << yaw_deg;
  }
  course.begin_approach();
  now.attitude.yaw = 0.0;
  EXPECT_FALSE(g.turn_ahead(now, course)) << "it has been done";
}

// A mean over the last second of (a - b) / k, k being -0.55 and the filter's -0.50.
TEST(PaperGuidance, ATurnBeginsWithTheMeanSpeedOfTheLastSecond) {
  PaperGuidance g = guidance();
  const Course course = two_lanes();
  Phase phase = Straight{};
  for (int i = 0; i < 512; ++i)
    (void)g.command(phase, paper_state_at({-3, 0, 0}, {1.0, 0, 0}), course);
  EXPECT_NEAR(g.entry_speed({}), 0.50 / 0.55, 1e-9);
  for (int i = 0; i < 256; ++i)
    (void)g.command(phase, paper_state_at({-3, 0, 0}, {2.0, 0, 0}), course);
  EXPECT_NEAR(g.entry_speed({}), 1.5 * 0.50 / 0.55, 1e-9);
}

TEST(PaperGuidance, LooksOnStraightsOnlyAndTakesOffForward) {
  PaperGuidance g = guidance();
  EXPECT_TRUE(g.uses_pictures(Straight{}));
  EXPECT_TRUE(g.uses_pictures(TakeOff{}));
  for (const Phase& blind : {Phase{Turn{}}, Phase{Land{}}, Phase{OnGround{}}})
    EXPECT_FALSE(g.uses_pictures(blind));
  Phase phase = TakeOff{};
  const AttitudeCommand c =
      g.command(phase, paper_state_at({-6, 0.5, 1.5}, Vector3d::Zero()), two_lanes());
  EXPECT_EQ(c.roll, 0.0);
  EXPECT_EQ(c.pitch, kParams.pitch);
  EXPECT_GT(c.thrust, 9.81) << "up";
}

}  // namespace
}  // namespace gatefly
