// SPDX-License-Identifier: Apache-2.0
#include "gatefly/control/attitude_rates.hpp"

#include <cmath>
#include <deque>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;
constexpr double kRatesDt = 1.0 / 512;

/// An autopilot that obeys rates after a dead time, then with a lag.
struct Obeying {
  double dead = 0.05, lag = 0.05;
  std::deque<Vector3d> on_their_way;
  Vector3d rate = Vector3d::Zero();
  Quaternion q;

  void fly(const Vector3d& rates) {
    on_their_way.push_back(rates);
    if (on_their_way.size() > static_cast<std::size_t>(dead / kRatesDt)) {
      rate += kRatesDt / lag * (on_their_way.front() - rate);
      on_their_way.pop_front();
    }
    q = integrated(q, rate, kRatesDt);
  }
};

/// Overshoot of a step of 20°, as a part of it.
double overshoot(const RateParams& params, double dead, double lag) {
  AttitudeRates rates{params, 2.8};
  Obeying drone{.dead = dead, .lag = lag, .on_their_way = {}, .rate = Vector3d::Zero(), .q = {}};
  double most = 0.0;
  for (int i = 0; i < 1024; ++i) {
    drone.fly(rates.step({.roll = 20.0 * kDegree}, rotation_EB(drone.q), kRatesDt));
    most = std::max(most, attitude_of(rotation_EB(drone.q)).roll / (20.0 * kDegree));
  }
  EXPECT_NEAR(attitude_of(rotation_EB(drone.q)).roll, 20.0 * kDegree, 0.5 * kDegree);
  return most - 1.0;
}

TEST(AttitudeRates, DoNotRingWhereADelayWouldMakeThem) {
  const RateParams params{.attitude_gain = 10.0};
  EXPECT_LT(overshoot(params, 0.05, 0.05), 0.10);
  RateParams ignorant = params;
  ignorant.response = 1e-3;
  EXPECT_GT(overshoot(ignorant, 0.05, 0.05), 0.25);
}

TEST(AttitudeRates, BearADelayHalfAsLongAgain) {
  EXPECT_LT(overshoot({}, 0.10, 0.05), 0.25);
  EXPECT_LT(overshoot({}, 0.02, 0.03), 0.05);
}

TEST(AttitudeRates, TiltAsToldWhileTheNoseIsStillElsewhere) {
  // 20 degrees to the right of a heading that is 120 degrees away: the thrust has to point there long
  // before the nose does, and on no way round.
  const AttitudeCommand wanted{.roll = 20.0 * kDegree, .yaw = 120.0 * kDegree};
  const Vector3d down_E = rotation_EB(Attitude{wanted.roll, 0.0, wanted.yaw}).matrix.col(2);
  AttitudeRates rates{RateParams{}, 1.0};
  Obeying drone;
  double aside = 0.0;
  for (int i = 0; i < 512; ++i) {
    drone.fly(rates.step(wanted, rotation_EB(drone.q), kRatesDt));
    const Vector3d now_E = rotation_EB(drone.q).matrix.col(2);
    aside = std::max(aside, std::abs(down_E.cross(Vector3d::UnitZ()).normalized().dot(now_E)));
  }
  const RotationEB end = rotation_EB(drone.q);
  EXPECT_GT(120.0 * kDegree - attitude_of(end).yaw, 50.0 * kDegree) << "the nose takes longer";
  EXPECT_LT(std::acos(end.matrix.col(2).dot(down_E)), 2.0 * kDegree);
  EXPECT_LT(aside, std::sin(4.0 * kDegree)) << "tilted to no other side";
}

TEST(AttitudeRates, TurnTheShortWayAndNoFasterThanAllowed) {
  AttitudeRates rates{RateParams{}, 1.5};
  const RotationEB now = rotation_EB(Attitude{0, 0, 170.0 * kDegree});
  const Vector3d asked = rates.step({.yaw = -170.0 * kDegree}, now, kRatesDt);
  EXPECT_GT(asked.z(), 0.5);
  AttitudeRates again{RateParams{}, 1.5};
  EXPECT_NEAR(
      again.step({.yaw = 80.0 * kDegree}, rotation_EB(Attitude{0, 0, 170.0 * kDegree}), kRatesDt)
          .z(),
      -1.5, 1e-9);
}

TEST(AttitudeRates, FeedAYawRateForward) {
  AttitudeRates rates{RateParams{}, 2.8};
  EXPECT_NEAR(rates.step({.yaw_rate = 0.7}, {}, kRatesDt).z(), 0.7, 1e-9);
}

TEST(SpeedsFor, AreThoseWhoseThrustIsMeantWithinTheRotorsLimits) {
  const VehicleParams vehicle;
  const auto speeds = speeds_for(kGravity, vehicle);
  EXPECT_NEAR(4 * vehicle.thrust_coefficient * speeds[0] * speeds[0], vehicle.mass * kGravity,
              1e-9);
  EXPECT_EQ(speeds[0], speeds[3]);
  EXPECT_LE(speeds_for(1e9, vehicle)[0], vehicle.max_speed);
  EXPECT_GE(speeds_for(0.0, vehicle)[0], vehicle.min_speed);
}

}  // namespace
}  // namespace gatefly
