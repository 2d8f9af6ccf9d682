// SPDX-License-Identifier: Apache-2.0
// An autopilot's IMU: slow, late, without stamps. What is lost by it, and what is not.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/estimation/eskf/error_state_filter.hpp"
#include "gatefly/estimation/eskf/look_ahead.hpp"
#include "gatefly/estimation/eskf/slow_imu.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly::eskf {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::for_all;
using test::IsNear;
using test::normal;

constexpr double kSpeed = 2.0, kTurn = 1.5, kPeriod = 5.0;  // [m/s] [rad/s] [s]

// A coordinated turn of 180° every 5 s, to the right, rolled into and out of within 0.6 s.
struct Pose {
  Matrix3d R_EB;
  Vector3d v_E;
};

double turn_rate(double t) {
  const double into = std::fmod(t, kPeriod) - 1.0, left = kPi / kTurn + 0.6 - into;
  const auto ramp = [](double x) { return 0.5 - 0.5 * std::cos(kPi * std::clamp(x, 0.0, 1.0)); };
  return kTurn * ramp(into / 0.6) * ramp(left / 0.6);
}

// The heading, as an integral of that by Simpson's rule, kept in steps of 1 ms.
double heading(double t) {
  static const std::vector<double> kHeadings = [] {
    std::vector<double> all{0.0};
    for (int i = 0; i < 90'000; ++i) {
      const double a = 1e-3 * i;
      all.push_back(all.back() +
                    1e-3 / 6.0 * (turn_rate(a) + 4 * turn_rate(a + 5e-4) + turn_rate(a + 1e-3)));
    }
    return all;
  }();
  const double at = std::floor(t / 1e-3), rest = t - 1e-3 * at;
  return kHeadings[static_cast<std::size_t>(at)] + rest * turn_rate(1e-3 * at + 0.5 * rest);
}

Pose pose(double t) {
  const double yaw = heading(t), roll = std::atan(kSpeed * turn_rate(t) / kGravity);
  return {rotation_EB(Attitude{roll, 0.0, yaw}).matrix,
          kSpeed * Vector3d{std::cos(yaw), std::sin(yaw), 0.0}};
}

Imu imu_at(double t) {
  constexpr double kStep = 1e-3;
  const Pose now = pose(t), before = pose(t - kStep), after = pose(t + kStep);
  const Vector3d a_E = (after.v_E - before.v_E) / (2 * kStep);
  return {turn_of(before.R_EB.transpose() * after.R_EB) / (2 * kStep),
          now.R_EB.transpose() * (a_E - Vector3d{0, 0, kGravity})};
}

Nominal state_at(double t) {
  Nominal x;
  x.R_EB = pose(t).R_EB, x.v_E = pose(t).v_E;
  return x;
}

struct Off {
  double attitude, velocity;  ///< [rad] [m/s]
};
Off off(const Nominal& x, double t) {
  return {turn_of(pose(t).R_EB.transpose() * x.R_EB).norm(), (x.v_E - pose(t).v_E).norm()};
}

constexpr double kStart = 0.5;

// By the straight line between two samples, each as late as said: what is off where the last was taken.
Off by_slow_imu(
    double hz, double seconds, const std::function<double()>& late = [] { return 0.0; }) {
  SlowImu slow{hz};
  Nominal x = state_at(kStart);
  double t = kStart, last = 0.0;
  for (int i = 0; t < kStart + seconds; ++i) {
    t = kStart + i / hz;
    slow.add(imu_at(t), last = std::max(last + 1e-3, t + late()));
    for (const Sample& piece : slow.pieces()) propagate(x, piece, kGravity);
  }
  return off(x, t);
}

// By holding each sample until the next.
Off by_holding(double hz, double seconds) {
  Nominal x = state_at(kStart);
  double t = kStart;
  for (int i = 1; t < kStart + seconds; ++i) {
    t = kStart + i / hz;
    propagate(x, {imu_at(kStart + (i - 1) / hz), 1.0 / hz}, kGravity);
  }
  return off(x, t);
}

TEST(SlowImu, FourHalfCirclesByItAreThoseOfAFastOne) {
  const Off fast = by_slow_imu(512.0, 20.0), slow = by_slow_imu(50.0, 20.0);
  EXPECT_LT(fast.attitude, 0.01 * kDegree);
  EXPECT_LT(slow.attitude, 0.05 * kDegree);
  EXPECT_LT(slow.velocity, 0.02);
  EXPECT_LT(by_slow_imu(25.0, 20.0).attitude, 0.2 * kDegree);
}

// In the middle of rolling half an interval is missing: that is what moves a picture's gate.
TEST(SlowImu, AStraightLineIsNotHalfAnIntervalLate) {
  const double rolling = 1.3 - kStart;
  for (const double hz : {25.0, 50.0, 100.0}) {
    const double held = by_holding(hz, rolling).attitude;
    EXPECT_GT(held, 0.3 * kTurn * 0.25 / hz) << hz;
    EXPECT_LT(by_slow_imu(hz, rolling).attitude, 0.1 * held) << hz;
  }
}

// Late by 5 ms, which is a quarter of the interval: what is too long now is too short then.
TEST(SlowImu, ArrivingIrregularlyItShiftsNoVelocity) {
  for (const double seconds : {10.0, 40.0, 160.0})
    for_all(10, [&](Rng& rng) {
      SlowImu slow{50.0};
      Nominal x;
      const double change = 4.0;  // [m/s²], once a second to and fro
      for (int i = 0; i <= static_cast<int>(50 * seconds); ++i) {
        const double t = i / 50.0;
        const Imu imu{Vector3d::Zero(), {change * std::sin(2 * kPi * t), 0.0, -kGravity}};
        slow.add(imu, t + std::abs(0.005 * normal(rng)));
        for (const Sample& piece : slow.pieces()) propagate(x, piece, kGravity);
      }
      EXPECT_NEAR(x.v_E.x(), 0.0, 0.02 * std::sqrt(seconds));  // a random walk, no drift
      EXPECT_NEAR(x.v_E.z(), 0.0, 1e-6) << seconds;
    });
}

TEST(SlowImu, ArrivingIrregularlyItTurnsTheAttitudeByLessThanATiltIsKnownTo) {
  for_all(10, [](Rng& rng) {  // sixteen half circles
    EXPECT_LT(by_slow_imu(50.0, 80.0, [&] { return std::abs(0.005 * normal(rng)); }).attitude,
              0.6 * kDegree);
  });
}

TEST(SlowImu, IsCutIntoPiecesOfATickThatAddUp) {
  for (const double hz : {25.0, 50.0, 100.0, 512.0}) {
    SlowImu slow{hz};
    EXPECT_TRUE(slow.pieces().empty());
    slow.add({Vector3d{1, 0, 0}, Vector3d{0, 0, -9}}, 1.0);
    EXPECT_TRUE(slow.pieces().empty());
    slow.add({Vector3d{3, 0, 0}, Vector3d{0, 0, -10}}, 1.0 + 1.0 / hz);
    Vector3d turned = Vector3d::Zero(), pushed = Vector3d::Zero();
    double dt = 0.0;
    for (const Sample& piece : slow.pieces()) {
      EXPECT_LE(piece.dt, 1.5 / kTickHz);
      turned += piece.dt * piece.imu.gyro_B, pushed += piece.dt * piece.imu.accel_B, dt += piece.dt;
    }
    EXPECT_NEAR(dt, 1.0 / hz, 1e-12) << hz;
    EXPECT_THAT(turned, IsNear(Vector3d{2.0 / hz, 0, 0}, 1e-12)) << hz;
    EXPECT_THAT(pushed, IsNear(Vector3d{0, 0, -9.5 / hz}, 1e-12)) << hz;
  }
}

TEST(SlowImu, AGapCountsAsNoMoreThanATenthOfASecond) {
  SlowImu slow{50.0};
  slow.add(imu_at(1.0), 1.0);
  slow.add(imu_at(4.0), 4.0);
  double dt = 0.0;
  for (const Sample& piece : slow.pieces()) dt += piece.dt;
  EXPECT_NEAR(dt, 0.1, 1e-9);
}

TEST(LookAhead, GoesOnAsTheFilterItselfWould) {
  for_all(50, [](Rng& rng) {
    Nominal x = state_at(rng.uniform(0.5, 5.0));
    x.p_EB = {1.0, -2.0, -1.5}, x.gyro_bias = {0.01, -0.02, 0.03}, x.accel_bias = {0.1, 0.2, -0.3};
    const Vector3d accel = {rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-12, -8)};
    LookAhead ahead;
    ahead.restart(accel - x.accel_bias, 1.0);
    Nominal expected = x;
    for (int i = 1; i <= 20; ++i) {
      const Vector3d gyro = imu_at(3.0 + 0.002 * i).gyro_B;
      propagate(expected, {{gyro, accel}, 0.002}, kGravity);
      ahead.turn(gyro - x.gyro_bias, 1.0 + 0.002 * i);
    }
    ahead.carry(x, kGravity);
    EXPECT_THAT(x.p_EB, IsNear(expected.p_EB, 1e-12));
    EXPECT_THAT(x.v_E, IsNear(expected.v_E, 1e-12));
    EXPECT_THAT(x.R_EB, IsNear(expected.R_EB, 1e-12));
    EXPECT_EQ(x.rate_B, expected.rate_B);
  });
}

// --- the filter ---

Setup slow_setup(double hz) {
  Setup setup;
  setup.slow_imu_hz = hz;
  setup.map.push_back({{5.0, 0.0, -1.5}, 0.0, {1.0, 0.05}});
  return setup;
}

struct Flown {
  ErrorStateFilter filter;
  double t = kStart;
};

// At 512 Hz, of which the filter gets `hz`; it starts as it stands.
Flown flown(const Setup& setup, double seconds, bool looks_ahead = true) {
  Flown flight{.filter = ErrorStateFilter{setup}};
  flight.filter.predict_slow(imu_at(kStart), kStart);
  flight.filter.start({.R_EB = pose(kStart).R_EB, .rest_accel_B = {}}, kStart);
  double next = kStart;
  for (int i = 1; i <= static_cast<int>(512 * seconds); ++i) {
    flight.t = kStart + i / 512.0;
    if (flight.t >= next + 1.0 / setup.slow_imu_hz) {
      next += 1.0 / setup.slow_imu_hz;
      flight.filter.predict_slow(imu_at(flight.t), flight.t);
    }
    if (looks_ahead) flight.filter.look_ahead(imu_at(flight.t).gyro_B, flight.t);
  }
  return flight;
}

TEST(ErrorStateFilter, BetweenSlowSamplesWhoSteersHasTheFastGyrosAttitude) {
  for (const double hz : {25.0, 50.0}) {
    const eskf::Setup setup = slow_setup(hz);
    for (int k = 0; k < 20; ++k) {  // while it rolls, at any phase of a sample
      const Flown flight = flown(setup, 0.8 + k / 512.0);
      const Nominal& now = flight.filter.now();
      EXPECT_LT(off(now, flight.t).attitude, 0.2 * kDegree) << hz;
      EXPECT_THAT(now.rate_B, IsNear(imu_at(flight.t).gyro_B, 1e-3));
    }
  }
}

TEST(ErrorStateFilter, NothingOfWhatLooksAheadComesBackIntoIt) {
  const eskf::Setup setup = slow_setup(50.0);
  // Both end with a slow sample.
  const double seconds = 3.0 + 1.0 / 512.0;
  Flown with = flown(setup, seconds), without = flown(setup, seconds, false);
  with.filter.predict_slow(imu_at(with.t), with.t + 0.02);
  without.filter.predict_slow(imu_at(with.t), with.t + 0.02);
  EXPECT_EQ(with.filter.now().p_EB, without.filter.now().p_EB);
  EXPECT_EQ(with.filter.now().R_EB, without.filter.now().R_EB);
  EXPECT_EQ(with.filter.covariance(), without.filter.covariance());
}

// The gate as it shows at any moment, from where the drone really was then.
GateSight sight_of_gate(const Setup& setup, const Nominal& truth, double time) {
  GateSight sight{.time = time, .features = {}};
  for (std::uint8_t i = 0; i < 4; ++i) {
    const Vector3d p_E = setup.map[0].p_EG + gate_corners_G(1.0)[i] - truth.p_EB;
    const Vector3d c = setup.R_BC.transpose() * (truth.R_EB.transpose() * p_E);
    (void)sight.features.push_back({.which = i, .bearing_C = c.normalized()});
  }
  return sight;
}

TEST(ErrorStateFilter, APictureBetweenSlowTicksIsTakenForWhenItWas) {
  eskf::Setup setup = slow_setup(25.0);
  setup.R_BC = camera_mount(0.0).matrix;
  for (int k = 0; k < 40; ++k) {  // turning at 1.5 rad/s with the gate ahead: 40 ms are 3.4°
    const Flown flight = flown(setup, 1.1 + k / 512.0);
    const double then = flight.t - 0.05;
    Nominal truth =
        flight.filter.now();  // where it believes to have been, which the law is not about
    truth.p_EB -= 0.05 * truth.v_E;
    truth.R_EB = pose(then).R_EB;
    const auto innovation = flight.filter.innovation_of(sight_of_gate(setup, truth, then));
    ASSERT_TRUE(innovation);
    EXPECT_LT(innovation->nis, 0.3) << k;
  }
}

// A floor seen while the last sample is 30 ms old, climbing at 2 m/s: 6 cm that are no error.
TEST(ErrorStateFilter, AHeightIsOfNowAndNotOfTheLastSlowSample) {
  const eskf::Setup setup = slow_setup(25.0);
  ErrorStateFilter filter{setup};
  const Imu climbs{Vector3d::Zero(), {0, 0, -kGravity - 2.0}};
  filter.predict_slow(climbs, 0.0);
  filter.start({.rest_accel_B = {}}, 0.0);
  double t = 0.0;
  for (int i = 1; i <= 25; ++i) filter.predict_slow(climbs, t = 0.04 * i);
  filter.look_ahead(Vector3d::Zero(), t += 0.03);
  const double height = 0.5 * 2.0 * t * t;
  ASSERT_NEAR(-filter.now().p_EB.z(), height, 1e-3);
  EXPECT_TRUE(filter.correct_height(height, 0.01));
  EXPECT_NEAR(-filter.now().p_EB.z(), height, 2e-3);
}

}  // namespace
}  // namespace gatefly::eskf
