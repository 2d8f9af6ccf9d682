// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/guidance.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;

constexpr double kDt = 1.0 / 512;

/// One gate 6 m ahead, nothing else.
Course straight_course() {
  Track track;
  track.gates = {{{6, 0, -1.5}, 0.0}};
  return {track, {}};
}

/// Somewhere on the way to the gate, level, flying along x.
NavigationState state_at(const Vector3d& p_EB, double speed, double time = 10.0) {
  NavigationState now;
  now.time = time, now.dt = kDt;
  now.p_EB = p_EB, now.v_E = now.v_B = now.v_GB = {speed, 0, 0};
  now.p_GB = p_EB - Vector3d{6, 0, -1.5};
  now.since_fix = 0.0;
  return now;
}

AttitudeCommand on_straight(const NavigationState& now) {
  Course course = straight_course();
  for (double x = 0.0; x <= now.p_EB.x(); x += 0.2)
    (void)course.follow(state_at({x, 0, -1.5}, 0), Straight{});
  Guidance guidance{{}};
  Phase phase = Straight{};
  return guidance.command(phase, now, course);
}

// Li18 Eq. (22): beside the line it rolls back to it; at rest on it, it does not roll.
TEST(Guidance, RollsBackOntoTheLine) {
  EXPECT_NEAR(on_straight(state_at({2, 0, -1.5}, 1.7)).roll, 0.0, 1e-12);
  EXPECT_LT(on_straight(state_at({2, 0.3, -1.5}, 1.7)).roll, -0.05) << "too far right: to the left";
  EXPECT_GT(on_straight(state_at({2, -0.3, -1.5}, 1.7)).roll, 0.05);
  NavigationState drifting = state_at({2, 0, -1.5}, 1.7);
  drifting.v_E.y() = 0.5;
  EXPECT_NEAR(on_straight(drifting).roll, -0.5 * LateralParams{}.kd, 1e-12);
}

// θ_0 of the paper: at the wanted speed the pitch is what drag asks for; slower is nose down.
TEST(Guidance, PitchHoldsTheSpeed) {
  const GuidanceParams params;
  const double trim = std::atan(params.drag.x() * params.cruise / params.gravity);
  EXPECT_NEAR(on_straight(state_at({2, 0, -1.5}, params.cruise)).pitch, trim, 1e-9);
  EXPECT_LT(on_straight(state_at({2, 0, -1.5}, 1.0)).pitch, trim - 0.05);
  EXPECT_GT(on_straight(state_at({2, 0, -1.5}, 2.4)).pitch, trim + 0.05);
}

// Drag pushes as hard as the air moves past it: wind that is known is leant against, by what drag makes of
// it; wind that may be none is not.
TEST(Guidance, LeansAgainstWindThatItIsSureOf) {
  const GuidanceParams params;
  NavigationState calm = state_at({2, 0, -1.5}, params.cruise), windy = calm;
  windy.wind_E = {-0.6, 0.8};  // from ahead, to the right
  EXPECT_NEAR(on_straight(windy).roll, params.drag.y() * 0.8 / params.gravity, 1e-9);
  EXPECT_NEAR(on_straight(windy).pitch,
              std::atan(params.drag.x() * (params.cruise + 0.6) / params.gravity), 1e-9);
  windy.wind_variance = 0.5;
  EXPECT_NEAR(on_straight(windy).roll, 0.5 * params.drag.y() * 0.8 / params.gravity, 1e-9);
  windy.wind_variance = 1.1;
  EXPECT_EQ(on_straight(windy).roll, on_straight(calm).roll);
  EXPECT_EQ(on_straight(windy).pitch, on_straight(calm).pitch);
}

TEST(Guidance, ThrustCarriesTheWeightAndMore) {
  EXPECT_NEAR(on_straight(state_at({2, 0, -1.5}, 1.7)).thrust, 9.81, 0.4);
  EXPECT_GT(on_straight(state_at({2, 0, -1.0}, 1.7)).thrust, 11.0) << "too low: climb";
  EXPECT_LT(on_straight(state_at({2, 0, -2.0}, 1.7)).thrust, 9.0);
}

// On a ramp at its height and rate, nothing but the weight is carried; at its height and level, it is
// told to climb.
TEST(Guidance, FeedsTheRateOfARampForward) {
  Track track;
  track.gates = {{{3, 0, -1.5}, 0.0}, {{11, 0, -3.5}, 0.0}};
  Course course{track, {}};
  for (double x = 0.0; x <= 7.0 || course.passed() == 0; x += 0.05) {
    NavigationState now = state_at({x, 0, -1.5}, 1.7);
    now.p_GB = now.p_EB - course.gate().p_EG;
    (void)course.follow(now, Straight{});
  }
  ASSERT_EQ(course.passed(), 1);
  const PathHeight ramp = course.path().height_at(course.progress());
  ASSERT_LT(ramp.slope, -0.2) << "it climbs";
  const auto thrust_with = [&](double vz) {
    NavigationState now = state_at({3 + course.progress(), 0, ramp.z}, 1.0);
    now.v_E.z() = vz;
    Phase phase = Straight{};
    return Guidance{{}}.command(phase, now, course).thrust;
  };
  EXPECT_NEAR(thrust_with(ramp.slope * 1.0), 9.81, 0.01);
  EXPECT_GT(thrust_with(0.0), 9.81 - 0.9 * AltitudeParams{}.kd * ramp.slope);
}

// Before a stop it holds the place and turns to where it leaves.
TEST(Guidance, StandsAndTurnsAtAStop) {
  Track track;
  track.gates = {{{6, 0, -1.5}, 0.0}};
  track.room_center = {3, 0}, track.room_size = {10, 2.6}, track.ceiling = 3.0;
  track.start_heading = kPi;  // no room for an arc: turns on its pad
  const Course course{track, {}};
  ASSERT_NE(course.stop(), nullptr);
  NavigationState now = state_at({0, 0.2, -1.5}, 0.0);
  now.attitude.yaw = kPi;
  Phase phase = Straight{};
  const AttitudeCommand c = Guidance{{}}.command(phase, now, course);
  EXPECT_NEAR(c.yaw, 0.0, 1e-9);
  EXPECT_LT(c.roll, -0.01) << "back to the pad, in the axes of the heading that it turns to";
  EXPECT_NEAR(c.pitch, 0.0, 1e-6);
}

// Flying along x with a gate to the right of the way: the nose turns to it, no faster than it may, and what
// was forward is then to the left.
TEST(Guidance, LooksAsideAtTheGateAndFliesOnAlongItsWay) {
  Track track;
  track.gates = {{{6, 0, -1.5}, 0.0}, {{6, 8, -1.5}, kPi}};
  track.laps = 2;
  Course course{track, {}};
  NavigationState now = state_at({6.2, 0, -1.5}, 1.0);
  now.p_GB = {0.2, 0, 0};
  for (double x = 0.0; x < 6.3; x += 0.2) {
    now.p_EB.x() = x, now.p_GB.x() = x - 6.0;
    (void)course.follow(now, Straight{});
  }
  ASSERT_EQ(course.target(), 1);
  GuidanceParams params;
  params.look_aside.most = 0.0;
  Phase phase = Straight{};
  const AttitudeCommand ahead = Guidance{params}.command(phase, now, course);
  EXPECT_NEAR(ahead.yaw, 0.0, 1e-9) << "as the paper flies";
  ASSERT_LT(ahead.pitch, -0.05) << "slower than wanted: nose down";
  params.look_aside.most = kPi;
  Guidance guidance{params};
  AttitudeCommand c;
  for (double t = 0.0; t < 3.0; t += kDt) {
    const AttitudeCommand next = guidance.command(phase, now, course);
    EXPECT_LE(std::abs(next.yaw - c.yaw), params.look_aside.rate * kDt + 1e-9);
    c = next;
  }
  EXPECT_NEAR(c.yaw, std::atan2(8.0, -0.2), 1e-6) << "it points at the gate";
  EXPECT_LT(c.roll, -0.05) << "forward is to the left now";
  now.attitude.yaw = c.yaw;
  (void)guidance.command(phase, now, course);
  EXPECT_NEAR(guidance.entry_speed(now), -0.2 / std::hypot(8.0, 0.2), 1e-3)
      << "along the way it flies what the nose sees as its left";
}

TEST(Guidance, LooksAsideNoFartherThanToldAndNotAtTheGateItself) {
  GuidanceParams params;
  params.look_aside.most = 0.3;
  const Course course = straight_course();
  Phase phase = Straight{};
  const auto yaw_at = [&](const Vector3d& p_EB) {
    Guidance guidance{params};
    AttitudeCommand c;
    for (double t = 0.0; t < 1.0; t += kDt)
      c = guidance.command(phase, state_at(p_EB, 1.0), course);
    return c.yaw;
  };
  EXPECT_NEAR(yaw_at({3, -3, -1.5}), 0.3, 1e-9);
  EXPECT_NEAR(yaw_at({3, 3, -1.5}), -0.3, 1e-9);
  EXPECT_NEAR(yaw_at({5.5, 0.3, -1.5}), 0.0, 1e-9) << "through it";
}

// Most nose up, that is, braking most, on the way from a gate to one that stands beside it and faces back.
double most_braking(double roll_lead) {
  Track track;
  track.gates = {{{6, 0, -1.5}, 0.0}, {{6, 2.4, -1.5}, kPi}};
  track.laps = 2;
  Course course{track, {}};
  for (double x = 0.0; x < 6.3; x += 0.2)
    (void)course.follow(state_at({x, 0, -1.5}, 1.7), Straight{});
  EXPECT_EQ(course.target(), 1);
  GuidanceParams params;
  params.speed.settle = 0.1;
  params.speed.roll_lead = roll_lead;
  Guidance guidance{params};
  Phase phase = Straight{};
  double most = -1.0;
  for (double s = 0.3; s < 0.8 * course.path().length(); s += 0.1) {
    const PathPoint here = course.path().at(s);
    NavigationState now = state_at({here.position.x(), here.position.y(), -1.5}, 1.6);
    now.attitude.yaw = here.heading;
    now.p_GB.x() = -3.0;
    (void)course.follow(now, Straight{});
    most = std::max(most, guidance.command(phase, now, course).pitch);
  }
  return most;
}

TEST(Guidance, SlowsWhereATurnIsTighterThanTheRollCanFollow) {
  EXPECT_GT(most_braking(0.5), most_braking(0.05) + 0.02);
}

TEST(Guidance, GoesSlowlyTowardsAGateThatItDoesNotSee) {
  NavigationState unseen = state_at({4, 0, -1.5}, 1.7);
  unseen.since_fix = 1.0, unseen.lateral_sigma = 0.4;
  EXPECT_GT(on_straight(unseen).pitch, on_straight(state_at({4, 0, -1.5}, 1.7)).pitch + 0.03)
      << "brakes";
}

TEST(Guidance, NearTheFloorATakeOffGoesStraightUp) {
  Guidance guidance{{}};
  Phase phase = TakeOff{};
  NavigationState low = state_at({0.5, 0.5, -0.1}, 0.0), high = state_at({0.5, 0.5, -0.5}, 0.0);
  const Course course = straight_course();
  const AttitudeCommand up = guidance.command(phase, low, course);
  EXPECT_EQ(up.roll, 0.0);
  EXPECT_EQ(up.pitch, 0.0);
  EXPECT_GT(up.thrust, 10.0);
  const AttitudeCommand back = guidance.command(phase, high, course);
  EXPECT_GT(back.pitch, 0.0) << "back to the pad, which is behind";
  EXPECT_LT(back.roll, 0.0);
}

// It waits where the phase says, looks ahead at first, then to both sides.
TEST(Guidance, ASearchWaitsOnTheAxisAndLooksAround) {
  Guidance guidance{{}};
  const Course course = straight_course();
  Phase phase = Search{10.0, -2.2};
  double least = 0.0, most = 0.0;
  for (double t = 10.0; t < 17.0; t += 0.1) {
    NavigationState now = state_at({3.8, 0, -1.5}, 0.0, t);
    now.since_fix = 5.0;
    const AttitudeCommand c = guidance.command(phase, now, course);
    EXPECT_NEAR(c.roll, 0.0, 1e-9) << "it is there";
    if (t < 11.4) {
      EXPECT_EQ(c.yaw, 0.0) << t;
    }
    least = std::min(least, c.yaw), most = std::max(most, c.yaw);
  }
  EXPECT_NEAR(least, -40.0 * kDegree, 0.02);
  EXPECT_NEAR(most, 40.0 * kDegree, 0.02);
  NavigationState seen = state_at({3.8, 0, -1.5}, 0.0, 16.2);
  EXPECT_EQ(guidance.command(phase, seen, course).yaw, 0.0) << "a gate in view: look at it";
}

// A drone that does not know its place stands, at the height of the way, and looks to all sides.
TEST(Guidance, StandsAndTurnsRound) {
  Guidance guidance{{}};
  const Course course = straight_course();
  Phase phase = Search{
      .since = 10.0, .gate_x = -3.0, .stand_at = Eigen::Vector2d{3, 0}, .yaw = 0.5, .rate = 1.2};
  double turned = 0.0, last = 0.5;
  for (double t = 10.0; t < 16.0; t += 0.1) {
    const AttitudeCommand c = guidance.command(phase, state_at({3, 0, -1.5}, 0.0, t), course);
    EXPECT_NEAR(c.roll, 0.0, 1e-9) << "it is there";
    EXPECT_NEAR(c.pitch, 0.0, 1e-9);
    turned += wrap_angle(c.yaw - last);
    last = c.yaw;
  }
  EXPECT_GT(turned, 2 * kPi);
  Phase beside = phase;
  EXPECT_LT(Guidance{{}}.command(beside, state_at({2, 0, -1.5}, 0.0, 10.0), course).pitch, -0.02);
}

// 1 s of a hold beside the place fills the integral; a new search starts without.
TEST(Guidance, ANewSearchStartsWithoutAnIntegral) {
  Guidance guidance{{}};
  const Course course = straight_course();
  const NavigationState aside = state_at({3.8, 0.3, -1.5}, 0.0);
  Phase first = Search{9.0, -2.2};
  const double fresh = guidance.command(first, aside, course).roll;
  double filled = fresh;
  for (int i = 0; i < 512; ++i) filled = guidance.command(first, aside, course).roll;
  EXPECT_LT(filled, fresh - 0.005);
  Phase straight = Straight{};
  (void)guidance.command(straight, aside, course);
  Phase second = Search{10.0, -2.2};
  EXPECT_EQ(guidance.command(second, aside, course).roll, fresh);
}

TEST(Guidance, ALandingBrakesThenSinks) {
  Guidance guidance{{}};
  const Course course = straight_course();
  Phase phase = Land{10.0, -1.5};
  EXPECT_GT(guidance.command(phase, state_at({3, 0, -1.5}, 1.5, 10.1), course).pitch, 0.1);
  const double level = guidance.command(phase, state_at({3, 0, -1.5}, 0.0, 10.5), course).thrust;
  EXPECT_LT(guidance.command(phase, state_at({3, 0, -1.5}, 0.0, 13.0), course).thrust, level - 1.0);
}

// An arc to the left, radius 1.5 m: it leans into it, and the roll leads the curve.
TEST(Guidance, TurnsAlongACurvedWay) {
  Track track;
  track.gates = {{{4, 0, -1.5}, 0.0}, {{0, -3, -1.5}, kPi}};
  track.laps = 2;
  Course course{track, {}};
  for (double s = 0.0; course.passed() == 0 && s < 8.0; s += 0.05) {
    NavigationState now = state_at({s, 0, -1.5}, 1.6);
    now.p_GB = now.p_EB - course.gate().p_EG;
    (void)course.follow(now, Straight{});
  }
  ASSERT_EQ(course.passed(), 1);
  Guidance guidance{{}};
  double before = 0.0;
  while (course.path().at(before).curvature == 0.0) before += 0.01;
  const auto near_the_turn = [&](double s) {
    const PathPoint here = course.path().at(s);
    NavigationState now = state_at({here.position.x(), here.position.y(), -1.5}, 1.6);
    now.p_GB = rotation_z(-kPi) * (now.p_EB - course.gate().p_EG);
    return now;
  };
  NavigationState now = near_the_turn(0.0);
  for (double s = 0.0; s < before - 0.15; s += 0.05)
    (void)course.follow(now = near_the_turn(s), Straight{});
  EXPECT_TRUE(guidance.turn_ahead(now, course)) << "0.26 m is 0.16 s";
  Phase phase = Turn{{.yaw = 0.0, .v_F = {1.6, 0, 0}}};
  EXPECT_LT(guidance.command(phase, now, course).roll, -0.1);
}

// Half a metre to the right and 3 m before the gate: the PD will have brought most of it back.
TEST(Guidance, PredictsWhereItWillPassTheGate) {
  const Guidance guidance{{}};
  const Course course = straight_course();
  NavigationState now = state_at({3, 0.5, -1.5}, 1.5);
  EXPECT_LT(guidance.lateral_at_gate(now, course), 0.2);
  EXPECT_GT(guidance.lateral_at_gate(now, course), 0.0);
  now.p_GB.x() = -0.1;
  EXPECT_NEAR(guidance.lateral_at_gate(now, course), 0.5, 1e-9) << "no time left";
}

// In the turn before a gate it is far from the gate's axis, and where it should be.
TEST(Guidance, InATurnThePredictionIsOffTheWay) {
  Track track;
  track.gates = {{{4, 0, -1.5}, 0.0}, {{0, -3, -1.5}, kPi}};
  track.laps = 2;
  Course course{track, {}};
  const Guidance guidance{{}};
  const auto at = [&](double s, double right) {
    const PathPoint here = course.path().at(s);
    const auto [sine, cosine] = sincos(here.heading);
    NavigationState now =
        state_at({here.position.x() - right * sine, here.position.y() + right * cosine, -1.5}, 0);
    now.v_E = 1.6 * Vector3d{cosine, sine, 0}, now.v_B = {1.6, 0, 0};
    now.p_GB = rotation_z(-course.gate().yaw_EG) * (now.p_EB - course.gate().p_EG);
    now.v_GB = rotation_z(-course.gate().yaw_EG) * now.v_E;
    (void)course.follow(now, Straight{});
    return now;
  };
  for (double s = 0.0; course.passed() == 0 && s < 8.0; s += 0.05) (void)at(s, 0.0);
  ASSERT_EQ(course.passed(), 1);
  double last_turn = course.path().length();
  while (course.path().at(last_turn).curvature == 0.0) last_turn -= 0.01;
  for (double s = 0.0; s < last_turn - 0.5; s += 0.05) (void)at(s, 0.0);
  const NavigationState on_it = at(last_turn - 0.45, 0.0);
  ASSERT_GT(std::abs(on_it.p_GB.y()), 0.03) << "in the turn";
  EXPECT_NEAR(guidance.lateral_at_gate(on_it, course), 0.0, 0.01);
  EXPECT_GT(guidance.lateral_at_gate(at(last_turn - 0.4, 0.4), course), 0.02);
}

// y (1 + ωt) e^-ωt + v t e^-ωt, the response of a critically damped PD, at any distance.
TEST(Guidance, ThePredictionIsTheCriticallyDampedDecay) {
  const GuidanceParams params;
  const Guidance guidance{params};
  const Course course = straight_course();
  const double w = std::sqrt(params.lateral.kp * params.gravity);
  for (const double x : {-0.7, -1.5, -2.5, -4.0}) {
    NavigationState now = state_at({6.0 + x, 0.5, -1.5}, 1.5);
    now.v_GB.y() = -0.2;
    const double t = -x / 1.5 - 1.5 * params.speed.roll_lead, decay = std::exp(-w * t);
    EXPECT_NEAR(guidance.lateral_at_gate(now, course),
                0.5 * (1.0 + w * t) * decay - 0.2 * t * decay, 1e-3)
        << x;
  }
}

}  // namespace
}  // namespace gatefly
