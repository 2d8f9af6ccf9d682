// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/baseline/imu15.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/generators.hpp"

namespace gatefly::baseline {
namespace {

constexpr double kStep = 1.0 / 512.0;

/// A level circle of radius 1.5 m at 1.5 m/s, nose along the path: exact position and IMU.
struct Circle {
  double radius = 1.5, speed = 1.5;
  [[nodiscard]] double rate() const { return speed / radius; }
  [[nodiscard]] Eigen::Vector3d p(double t) const {
    return {radius * std::sin(rate() * t), radius * (1.0 - std::cos(rate() * t)), -1.5};
  }
  [[nodiscard]] double yaw(double t) const { return wrap_angle(rate() * t); }
  [[nodiscard]] Imu imu() const {
    return {.gyro_B = {0, 0, rate()}, .accel_B = {0, speed * rate(), -9.81}};
  }
};

struct Flown {
  Imu15 filter;
  double t = 0.0;

  void fly(const Circle& circle, double duration, const Eigen::Vector3d& accel_bias, bool fixes,
           Rng& rng) {
    Imu imu = circle.imu();
    imu.accel_B += accel_bias;
    const int steps = static_cast<int>(duration / kStep);
    for (int i = 0; i < steps; ++i) {
      filter.predict(imu, kStep);
      t += kStep;
      if (i % 34 != 0 || !fixes) continue;
      const Eigen::Vector3d noise{0.03 * test::normal(rng), 0.03 * test::normal(rng),
                                  0.03 * test::normal(rng)};
      filter.correct_position(circle.p(t) + noise, Eigen::Vector3d::Constant(0.03));
      filter.correct_heading(circle.yaw(t), 0.02);
    }
  }
};

// Twenty circles, 10 s with fixes and 2 s without: off by no more than it says, nearly always.
TEST(Imu15, KnowsHowFarItDriftsWithoutFixes) {
  const Circle circle;
  Imu15Params params;
  params.start_velocity_sigma = 2.0;  // it starts in full flight
  int within = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Flown flown{Imu15{params}};
    flown.filter.start(circle.p(0), {}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
    Rng rng{seed};
    flown.fly(circle, 10.0, Eigen::Vector3d::Zero(), true, rng);
    flown.fly(circle, 2.0, Eigen::Vector3d::Zero(), false, rng);
    const double sigma = std::sqrt(flown.filter.covariance().topLeftCorner<3, 3>().trace());
    within += (flown.filter.position() - circle.p(flown.t)).norm() < 2.0 * sigma;
    EXPECT_LT(sigma, 1.0);
  }
  EXPECT_GE(within, 18);
}

TEST(Imu15, LearnsTheAccelerometersBias) {
  const Circle circle;
  const Eigen::Vector3d bias{0.12, -0.08, 0.2};
  Flown flown{Imu15{Imu15Params{}}};
  flown.filter.start(circle.p(0), {}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  Rng rng{2};
  flown.fly(circle, 30.0, bias, true, rng);
  const double sigma = std::sqrt(
      flown.filter.covariance().block<3, 3>(Imu15::kAccelBias, Imu15::kAccelBias).trace());
  EXPECT_LT(sigma, 0.5 * Imu15Params{}.start_bias_sigma.norm());
  EXPECT_LT((flown.filter.accel_bias() - bias).norm(), 3.0 * sigma);
  EXPECT_LT((flown.filter.position() - circle.p(flown.t)).norm(), 0.08);
  EXPECT_NEAR(flown.filter.velocity().norm(), circle.speed, 0.1);
}

TEST(Imu15, ItsCovarianceStaysOneAndGrowsOnlyWhileNothingIsSeen) {
  const Circle circle;
  Flown flown{Imu15{Imu15Params{}}};
  flown.filter.start(circle.p(0), {}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  Rng rng{3};
  flown.fly(circle, 5.0, Eigen::Vector3d::Zero(), true, rng);
  const double seen = flown.filter.covariance()(0, 0);
  flown.fly(circle, 2.0, Eigen::Vector3d::Zero(), false, rng);
  const auto& P = flown.filter.covariance();
  EXPECT_GT(P(0, 0), 4.0 * seen);
  EXPECT_LT((P - P.transpose()).norm(), 1e-12);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Imu15::Covariance>(P).eigenvalues().minCoeff(), 0.0);
}

TEST(Imu15, AHeadingTurnsTheEstimateTheShortWay) {
  Imu15Params params;
  params.start_tilt_sigma = 1e-4;  // else heading and tilt share what was wrong
  Imu15 filter{params};
  filter.start(Eigen::Vector3d::Zero(), {0.1, -0.2, 3.1}, Eigen::Vector3d::Zero(),
               Eigen::Vector3d::Zero());
  for (int i = 0; i < 200; ++i) filter.correct_heading(-3.1, 0.01);
  EXPECT_NEAR(wrap_angle(filter.attitude().yaw + 3.1), 0.0, 0.01);
  EXPECT_NEAR(filter.attitude().roll, 0.1, 0.01);
  EXPECT_NEAR(filter.attitude().pitch, -0.2, 0.01);
}

TEST(Imu15, WhatIsNotFiniteChangesNothing) {
  Imu15 filter{Imu15Params{}};
  filter.start({1, 2, 3}, {}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  filter.predict({.gyro_B = {nan, 0, 0}, .accel_B = {0, 0, -9.81}}, kStep);
  filter.predict({}, nan);
  filter.correct_position({nan, 0, 0}, Eigen::Vector3d::Ones());
  filter.correct_heading(nan, 0.1);
  EXPECT_EQ(filter.position(), Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace gatefly::baseline
