// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/ahrs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector3d;

constexpr double kDt = 1.0 / 512;
const Vector3d kUp{0, 0, -9.81};

Ahrs at_rest(const Vector3d& gyro_bias, const Vector3d& accel_bias, double yaw = 0.0,
             int samples = 1024) {
  Ahrs ahrs{AhrsParams{}};
  ahrs.start(yaw);
  for (int i = 0; i < samples; ++i) ahrs.update_at_rest({gyro_bias, kUp + accel_bias});
  return ahrs;
}

TEST(Ahrs, StartsLevelAtTheHeadingItIsTold) {
  const Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero(), 1.2);
  EXPECT_NEAR(ahrs.attitude().yaw, 1.2, 1e-12);
  EXPECT_NEAR(ahrs.attitude().roll, 0, 1e-12);
  EXPECT_NEAR(ahrs.attitude().pitch, 0, 1e-12);
}

TEST(Ahrs, LearnsBothBiasesAtRest) {
  for_all(100, [](Rng& rng) {
    const Vector3d gyro = any_vector3(rng, 0.03), accel = any_vector3(rng, 0.3);
    const Ahrs ahrs = at_rest(gyro, accel);
    EXPECT_THAT(ahrs.gyro_bias(), IsNear(gyro, 1e-9));
    EXPECT_THAT(ahrs.accel_bias(), IsNear(accel, 1e-9));
    EXPECT_EQ(ahrs.rest_samples(), 1024);
  });
}

TEST(Ahrs, HandsOnTheDroneStartTheCalibrationAnew) {
  Ahrs ahrs = at_rest({0.01, 0, 0}, Vector3d::Zero());
  for (int i = 0; i < 100; ++i) ahrs.update_at_rest({Vector3d{1.0, 0.5, 0}, kUp});
  EXPECT_LT(ahrs.rest_samples(), 100);
  for (int i = 0; i < 2000; ++i) ahrs.update_at_rest({Vector3d{0.01, 0, 0}, kUp});
  EXPECT_THAT(ahrs.gyro_bias(), IsNear(Vector3d{0.01, 0, 0}, 0.003));
  EXPECT_GT(ahrs.rest_samples(), 1500);
}

TEST(Ahrs, ATumblingDroneNeverRests) {
  Ahrs ahrs{AhrsParams{}};
  ahrs.start(0);
  int most = 0;
  for (int i = 0; i < 3000; ++i) {
    ahrs.update_at_rest({Vector3d{2, -1, 0.5}, kUp});
    most = std::max(most, ahrs.rest_samples());
  }
  EXPECT_LT(most, 64);
}

TEST(Ahrs, IntegratesTheGyroWithoutItsBias) {
  const Vector3d bias{0.02, -0.01, 0.03};
  Ahrs ahrs = at_rest(bias, Vector3d::Zero());
  // Half a second of yaw at 1 rad/s, level.
  for (int i = 0; i < 256; ++i) ahrs.update({bias + Vector3d{0, 0, 1}, kUp}, Vector3d::Zero(), kDt);
  EXPECT_NEAR(ahrs.attitude().yaw, 0.5, 1e-3);
  EXPECT_NEAR(ahrs.attitude().roll, 0, 1e-4);
  EXPECT_THAT(ahrs.rate_B(), IsNear(Vector3d{0, 0, 1}, 1e-3));
}

// The filter thinks it is level, the drone leans: gravity pulls it there, from every side.
TEST(Ahrs, GravityCorrectsTheTilt) {
  for_all(20, [](Rng& rng) {
    Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero(), 0.5);
    const Attitude truth{rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), 0.5};
    const Vector3d accel = rotation_EB(truth).matrix.transpose() * kUp;
    for (int i = 0; i < 200 * 512; ++i)
      ahrs.update({Vector3d::Zero(), accel}, Vector3d::Zero(), kDt);
    EXPECT_NEAR(ahrs.attitude().roll, truth.roll, 0.003);
    EXPECT_NEAR(ahrs.attitude().pitch, truth.pitch, 0.003);
  });
}

TEST(Ahrs, FindsAGyroBiasThatCameAfterTheCalibration) {
  Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero());
  const Vector3d drift{0.01, -0.008, 0};
  for (int i = 0; i < 200 * 512; ++i) ahrs.update({drift, kUp}, Vector3d::Zero(), kDt);
  EXPECT_NEAR(ahrs.gyro_bias().x(), drift.x(), 0.001);
  EXPECT_NEAR(ahrs.gyro_bias().y(), drift.y(), 0.001);
  EXPECT_NEAR(ahrs.attitude().roll, 0, 0.003);
  EXPECT_NEAR(ahrs.attitude().pitch, 0, 0.003);
}

// A coordinated level turn of 10 s: without the velocity the filter would take the bank for level
// flight.
TEST(Ahrs, ACoordinatedTurnDoesNotLookLevel) {
  const double v = 1.8, yaw_rate = 1.2, g = 9.81;
  const double roll = std::atan(v * yaw_rate / g);
  Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero());
  ahrs.set({roll, 0, 0});
  const Eigen::Matrix3d R_FB = rotation_x(roll);
  const Vector3d gyro = R_FB.transpose() * Vector3d{0, 0, yaw_rate};
  const Vector3d v_B{v, 0, 0};
  // f = a - g: centripetal acceleration to the right, thrust up.
  const Vector3d accel = R_FB.transpose() * Vector3d{0, v * yaw_rate, -g};
  for (int i = 0; i < 10 * 512; ++i) ahrs.update({gyro, accel}, v_B, kDt);
  EXPECT_NEAR(ahrs.attitude().roll, roll, 0.01);
  EXPECT_NEAR(ahrs.attitude().pitch, 0, 0.01);
  EXPECT_NEAR(wrap_angle(ahrs.attitude().yaw - yaw_rate * 10), 0, 0.02);
}

// Speeding up and braking, level: with the velocity it is no pitch, without it is.
TEST(Ahrs, SpeedingUpDoesNotLookLikePitch) {
  double worst_with = 0, worst_without = 0;
  Ahrs with = at_rest(Vector3d::Zero(), Vector3d::Zero()), without = with;
  double v = 0;
  for (int i = 0; i < 4 * 512; ++i) {
    const double a = i < 1024 ? 1.5 : -1.5;
    v += a * kDt;
    const Imu imu{Vector3d::Zero(), kUp + Vector3d{a, 0, 0}};
    with.update(imu, Vector3d{v, 0, 0}, kDt);
    without.update(imu, Vector3d::Zero(), kDt);
    worst_with = std::max(worst_with, std::abs(with.attitude().pitch));
    worst_without = std::max(worst_without, std::abs(without.attitude().pitch));
  }
  EXPECT_LT(worst_with, 0.02 * kDegree);
  EXPECT_GT(worst_without, 1.5 * kDegree);
}

// 3 m/s² to and fro, at once and through a weight that knows the length only.
TEST(Ahrs, ShakingAboutZeroAveragesOut) {
  Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero());
  for (int i = 0; i < 20 * 512; ++i) {
    const Vector3d shake = 3.0 * std::sin(2 * kPi * 2.0 * i * kDt) * Vector3d{0.8, -0.5, 0.3};
    ahrs.update({Vector3d::Zero(), kUp + shake}, Vector3d::Zero(), kDt);
    EXPECT_LT(std::hypot(ahrs.attitude().roll, ahrs.attitude().pitch), 0.6 * kDegree);
  }
}

// The heading of the velocity just before turns with the correction: no sudden change of velocity.
TEST(Ahrs, AHeadingCorrectionInFlightLeavesTheTiltAlone) {
  Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero());
  ahrs.set({});
  for (int i = 0; i < 4 * 512; ++i) {
    if (i == 1024) ahrs.correct_heading(0.15, 1e-4);
    ahrs.update({Vector3d::Zero(), kUp}, Vector3d{1.8, 0, 0}, kDt);
    EXPECT_LT(std::hypot(ahrs.attitude().roll, ahrs.attitude().pitch), 0.01 * kDegree);
  }
  EXPECT_GT(ahrs.attitude().yaw, 0.1);
}

TEST(Ahrs, TheTiltsSigmaGrowsWithUnexplainedAccelerationAndShrinksAgain) {
  Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero());
  const auto fly = [&](const Imu& imu) {
    for (int i = 0; i < 10 * 512; ++i) ahrs.update(imu, Vector3d::Zero(), kDt);
    return ahrs.tilt_sigma();
  };
  const double hover = fly({Vector3d::Zero(), kUp});
  EXPECT_GT(hover, AhrsParams{}.accel_bias_sigma / 9.81);
  EXPECT_LT(hover, 0.7 * kDegree);
  EXPECT_GT(fly({Vector3d::Zero(), 1.15 * kUp}), 1.2 * hover);  // longer than g
  EXPECT_NEAR(fly({Vector3d::Zero(), kUp}), hover, 0.1 * hover);
  ahrs.update({Vector3d{4, 0, 0}, kUp}, Vector3d::Zero(), kDt);  // a rate is never quite of now
  EXPECT_GT(ahrs.tilt_sigma(), 1.2 * hover);
  EXPECT_TRUE(std::isfinite(ahrs.tilt_sigma()));
  ahrs.update({Vector3d::Zero(), kUp}, Vector3d::Zero(), 100.0);  // a pause of any length
  EXPECT_GT(ahrs.tilt_sigma(), 0.0);
}

// 200 hovers of 20 s: noise and vibration of a Bebop, biases that appear after the rest. Mean of
// e²/σ² over both axes: 1 when consistent; below when σ is too large.
TEST(Ahrs, TheTiltsSigmaIsConsistent) {
  double sum = 0;
  constexpr int kRuns = 200;
  for_all(kRuns, [&](Rng& rng) {
    Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero());
    const Vector3d accel_bias = 0.08 * Vector3d{normal(rng), normal(rng), normal(rng)};
    const Vector3d gyro_bias = 0.2 * kDegree * Vector3d{normal(rng), normal(rng), normal(rng)};
    for (int i = 0; i < 20 * 256; ++i) {
      const Vector3d gyro{0.06 * normal(rng), 0.06 * normal(rng), 0.05 * normal(rng)};
      const Vector3d accel{0.5 * normal(rng), 0.45 * normal(rng), 0.9 * normal(rng)};
      ahrs.update({gyro_bias + gyro, kUp + accel_bias + accel}, Vector3d::Zero(), 2 * kDt);
    }
    const Attitude e = ahrs.attitude();
    sum += (e.roll * e.roll + e.pitch * e.pitch) / (ahrs.tilt_sigma() * ahrs.tilt_sigma());
  });
  EXPECT_GT(sum / (2 * kRuns), 0.5);
  EXPECT_LT(sum / (2 * kRuns), 1.3);
}

TEST(Ahrs, HeadingConvergesToWhatGatesSayAndFindsTheYawBias) {
  const double truth = 0.3, drift = 0.004;  // started 0.1 rad off, with a yaw gyro that drifts
  Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero(), truth - 0.1);
  Rng rng{9};
  const double before = ahrs.heading_sigma();
  for (int i = 0; i < 60 * 512; ++i) {
    ahrs.update({Vector3d{0, 0, drift}, kUp}, Vector3d::Zero(), kDt);
    if (i % 51 == 0)
      ahrs.correct_heading(wrap_angle(truth - ahrs.attitude().yaw) + 0.05 * normal(rng),
                           0.05 * 0.05);
  }
  EXPECT_NEAR(ahrs.attitude().yaw, truth, 0.03);
  EXPECT_NEAR(ahrs.gyro_bias().z(), drift, 0.002);
  EXPECT_LT(ahrs.heading_sigma(), before);
}

TEST(Ahrs, HeadingSigmaGrowsWithoutGates) {
  Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero());
  double last = ahrs.heading_sigma();
  for (int second = 0; second < 10; ++second) {
    for (int i = 0; i < 512; ++i) ahrs.update({Vector3d::Zero(), kUp}, Vector3d::Zero(), kDt);
    EXPECT_GT(ahrs.heading_sigma(), last);
    last = ahrs.heading_sigma();
  }
}

TEST(Ahrs, AHeadingThatIsImpossibleIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero(), 0.2);
  ahrs.correct_heading(1.5, 0.01);
  ahrs.correct_heading(nan, 0.01);
  ahrs.correct_heading(0.1, nan);
  ahrs.correct_heading(0.1, 0.0);
  ahrs.correct_heading(0.1, -1.0);
  EXPECT_NEAR(ahrs.attitude().yaw, 0.2, 1e-12);
  EXPECT_TRUE(std::isfinite(ahrs.heading_sigma()));
}

TEST(Ahrs, StaysARotationThroughAHardFlight) {
  for_all(20, [](Rng& rng) {
    Ahrs ahrs = at_rest(any_vector3(rng, 0.02), any_vector3(rng, 0.2));
    for (int i = 0; i < 2000; ++i) {
      const Vector3d accel = kUp + any_vector3(rng, 12);
      ahrs.update({any_vector3(rng, 10), accel}, any_vector3(rng, 3), i % 100 == 0 ? 0.0 : kDt);
      if (i % 50 == 0) ahrs.correct_heading(rng.uniform(-0.2, 0.2), 0.01);
    }
    EXPECT_THAT(ahrs.R_EB().matrix, IsRotation());
  });
}

TEST(Ahrs, WeightlessnessOnlyIntegrates) {
  Ahrs ahrs = at_rest(Vector3d::Zero(), Vector3d::Zero());
  for (int i = 0; i < 512; ++i)
    ahrs.update({Vector3d::Zero(), Vector3d::Zero()}, Vector3d::Zero(), kDt);
  EXPECT_NEAR(ahrs.attitude().roll, 0, 1e-12);
  EXPECT_TRUE(ahrs.R_EB().matrix.allFinite());
}

}  // namespace
}  // namespace gatefly
