// SPDX-License-Identifier: Apache-2.0
// What the error-state filter learns about its noise: from an IMU's samples, and from corners' residuals.
#include <cmath>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/estimation/eskf/gate_sight.hpp"
#include "gatefly/estimation/eskf/vibration.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"

#include "support/generators.hpp"

namespace gatefly::eskf {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::normal;
using testing::DoubleNear;

// `times` as strong as usual, in variance, on top of a drone that sways at 3 Hz.
Vibration after_flying(double hz, double times, double seconds = 5.0) {
  Rng rng{7};
  const Noise noise;
  Vibration vibration{noise};
  const double accel = std::sqrt(times * noise.shaking.accel * hz / 3.0);
  const double gyro = std::sqrt(times * noise.shaking.gyro * hz / 3.0);
  for (int i = 0; i < static_cast<int>(seconds * hz); ++i) {
    const double sway = std::sin(2 * kPi * 3.0 * i / hz);
    const auto shaken = [&](double sigma) {
      return Vector3d{sigma * normal(rng), sigma * normal(rng), sigma * normal(rng)};
    };
    vibration.add(
        {{shaken(gyro) + Vector3d{sway, 0, 0}, shaken(accel) + Vector3d{0, 2 * sway, -9.8}},
         1.0 / hz});
  }
  return vibration;
}

TEST(EskfVibration, IsFoundInTheSamplesWhateverTheirRate) {
  for (const double hz : {200.0, 512.0, 1000.0})
    for (const double times : {0.5, 1.0, 4.0, 10.0}) {
      const Vibration found = after_flying(hz, times);
      EXPECT_THAT(found.accel(), DoubleNear(times, 0.25 * times)) << hz << " Hz";
      EXPECT_THAT(found.gyro(), DoubleNear(times, 0.25 * times)) << hz << " Hz";
    }
}

TEST(EskfVibration, KeepsWithinItsBoundsAndSaysNothingWithoutSamples) {
  EXPECT_EQ(Vibration{Noise{}}.accel(), 1.0);
  EXPECT_EQ(after_flying(512.0, 1000.0).accel(), Noise{}.most_shaking);
  EXPECT_EQ(after_flying(512.0, 0.0).gyro(), Noise{}.least_shaking);
}

TEST(EskfVibration, OneBrokenSampleIsNone) {
  Vibration vibration = after_flying(512.0, 1.0);
  const double before = vibration.accel();
  vibration.add({{Vector3d::Zero(), Vector3d{300.0, -300.0, 300.0}}, 1.0 / 512.0});
  EXPECT_LT(vibration.accel(), 1.05 * before);
}

// An autopilot's IMU at 50 Hz, shaking with `times` the least variance that is reckoned with.
struct SlowFlight {
  Rng rng{7};
  Noise noise;
  Vibration vibration{noise, true};

  void go(double seconds, double times) {
    constexpr double kHz = 50.0;
    const double sigma = std::sqrt(times * (2.0 * noise.accel + noise.accel_z) * kHz / 3.0);
    const double turn = std::sqrt(times * 6.0 * noise.attitude * kHz / 3.0);
    for (int i = 0; i < static_cast<int>(seconds * kHz); ++i) {
      const Vector3d shaken{normal(rng), normal(rng), normal(rng)};
      // Even a drone that stands still never repeats a sample: one that does is left out.
      vibration.add(
          {{1e-6 * shaken + turn * shaken, sigma * shaken + Vector3d{0, 0, -9.8}}, 1.0 / kHz});
    }
  }
};

TEST(EskfVibration, OfASlowImuIsHalfBelievedSoonAfterRotorsStartAndForgottenLater) {
  SlowFlight flight;
  flight.go(1.0, 0.0);
  EXPECT_EQ(flight.vibration.accel(), 1.0);
  flight.go(0.3, 30.0);
  EXPECT_GT(flight.vibration.accel(), 15.0);
  EXPECT_GT(flight.vibration.gyro(), 15.0);
  flight.go(0.2, 0.0);
  EXPECT_GT(flight.vibration.accel(), 10.0);
  flight.go(5.0, 0.0);
  EXPECT_LT(flight.vibration.accel(), 1.5);
}

TEST(EskfVibration, OfASlowImuCountsForTwiceAsMuchInTheMean) {
  SlowFlight flight;
  flight.go(3.0, 10.0);
  double accel = 0.0, gyro = 0.0;
  constexpr int kLooks = 200;
  for (int i = 0; i < kLooks; ++i) {
    flight.go(0.2, 10.0);
    accel += flight.vibration.accel() / kLooks, gyro += flight.vibration.gyro() / kLooks;
  }
  EXPECT_THAT(accel, DoubleNear(19.0, 4.0));
  EXPECT_THAT(gyro, DoubleNear(19.0, 4.0));
}

TEST(EskfVibration, OneBrokenSampleOfASlowImuCountsForLittleAfterASecond) {
  SlowFlight flight;
  flight.go(3.0, 10.0);
  const double before = flight.vibration.accel();
  flight.vibration.add({{Vector3d::Zero(), Vector3d{300.0, -300.0, 300.0}}, 1.0 / 50.0});
  EXPECT_GT(flight.vibration.accel(), 1.2 * before);
  flight.go(1.0, 10.0);
  EXPECT_LT(flight.vibration.accel(), 2.5 * before);
}

// A camera that knows where it is looks at a gate whose corners are found `times` as far off as told.
double spread_after(double times, int pictures) {
  Rng rng{11};
  const CameraModel camera;
  const SightNoise told;
  Nominal x;
  x.p_EB = {-3.0, 0.0, -1.5}, x.R_BC = camera_mount(0.0).matrix;
  x.gates[0].p_EG = {0.0, 0.0, -1.5};
  const Nominal truth = x;
  for (int k = 0; k < pictures; ++k) {
    GateSight sight;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector3d c =
          truth.R_BC.transpose() * (truth.gates[0].p_EG + gate_corners_G(1.0)[i] - truth.p_EB);
      const double sigma = times * told.own * camera.radians_per_px;
      const Vector2d off{sigma * normal(rng), sigma * normal(rng)};
      const Vector3d u = c / c.z() + Vector3d{off.x(), off.y(), 0.0};
      (void)sight.features.push_back({.which = static_cast<std::uint8_t>(i),
                                      .bearing_C = u.normalized(),
                                      .from_middle_px = c.head<2>() / c.z()});
    }
    // The learnt noise is all that the filter keeps from one picture to the next.
    Nominal now = truth;
    now.spread = x.spread, now.corner_of = face_of(sight);
    Covariance P = 1e-8 * Covariance::Identity(gate_at(1), gate_at(1));
    EXPECT_TRUE(correct_by_gate(now, P, sight, {1.0, 0.05}, 0.0, camera, told));
    x.spread = now.spread;
  }
  return x.spread;
}

TEST(EskfSpread, FollowsWhatCornersAreReallyOff) {
  EXPECT_LT(spread_after(1.0, 600), 1.3);
  EXPECT_THAT(spread_after(2.0, 600), DoubleNear(3.4, 1.0));  // what is shared was not doubled
  EXPECT_EQ(spread_after(10.0, 600), SightNoise{}.most_spread);
}

// Twice as good as told is luck, or corners that are off together.
TEST(EskfSpread, BelievesCornersAtMostTwiceAsMuchAsTold) {
  EXPECT_EQ(spread_after(0.2, 600), SightNoise{}.least_spread);
  EXPECT_GE(SightNoise{}.least_spread, 0.5);
}

}  // namespace
}  // namespace gatefly::eskf
