// SPDX-License-Identifier: Apache-2.0
// The outer loops of the simulator that speaks TS-002: a point mass that turns as it is told comes to where, and as, it was asked to.
#include "gatefly/simulated_race/link_sim/set_points.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::link_sim {
namespace {

using mavlink::SetAttitudeTarget;
using mavlink::SetPositionTargetLocalNed;

constexpr double kHover = 0.25;

Known at_rest(double yaw = 0.0) {
  return {{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}, {0, 0, yaw}, kHover};
}

/// Flown for some seconds by one set point: rates are obeyed at once, thrust acts along the body's axis.
template <class SetPoint>
Known after(double seconds, const SetPoint& target, Known is = at_rest()) {
  constexpr double kPeriod = 0.005;
  for (double t = 0.0; t < seconds; t += kPeriod) {
    const RatesAndThrust wanted = wanted_of(target, is);
    const Eigen::Matrix3d R = rotation_EB(is.attitude).matrix;
    const Eigen::Vector3d a_E =
        Eigen::Vector3d{0, 0, kGravity} - kGravity * wanted.thrust / kHover * R.col(2);
    is.place.p_EB += kPeriod * is.place.v_E;
    is.place.v_E += kPeriod * a_E;
    is.attitude = attitude_of(RotationEB{R * rotation_of(kPeriod * wanted.rates_B)});
  }
  return is;
}

TEST(SetPoints, AnAttitudeIsReached) {
  const gatefly::Attitude wanted{0.3, -0.2, 1.1};
  const Known is = after(2.0, mavlink::attitude_target({}, wanted, kHover, {}));
  EXPECT_NEAR(is.attitude.roll, wanted.roll, 1e-3);
  EXPECT_NEAR(is.attitude.pitch, wanted.pitch, 1e-3);
  EXPECT_NEAR(is.attitude.yaw, wanted.yaw, 1e-3);
}

TEST(SetPoints, RatesAreTakenAsTheyAreAndThrustWithinItsRange) {
  const Eigen::Vector3d rates{0.5, -0.4, 0.3};
  const RatesAndThrust wanted = wanted_of(mavlink::rate_target({}, rates, 0.4, {}), at_rest());
  EXPECT_TRUE(wanted.rates_B.isApprox(rates, 1e-6));
  EXPECT_NEAR(wanted.thrust, 0.4, 1e-6);
  SetAttitudeTarget more = mavlink::rate_target({}, rates, 0.4, {});
  more.thrust = 3.0f;
  EXPECT_EQ(wanted_of(more, at_rest()).thrust, 1.0);
  more.type_mask |= 64;
  EXPECT_EQ(wanted_of(more, at_rest()).thrust, kHover) << "thrust is to be ignored";
  more.type_mask |= 7;
  EXPECT_EQ(wanted_of(more, at_rest()).rates_B.norm(), 0.0) << "and so are the rates";
}

TEST(SetPoints, WhatIsNoNumberCountsAsNothing) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  SetAttitudeTarget bad;
  bad.q = {kNone, kNone, kNone, kNone};
  bad.body_roll_rate = bad.thrust = kNone;
  EXPECT_EQ(wanted_of(bad, at_rest()).rates_B.norm(), 0.0);
  EXPECT_EQ(wanted_of(bad, at_rest()).thrust, 0.0);
  SetPositionTargetLocalNed worse;
  worse.x = worse.vy = worse.afz = worse.yaw = worse.yaw_rate = kNone;
  EXPECT_TRUE(wanted_of(worse, at_rest()).rates_B.allFinite());
  EXPECT_TRUE(std::isfinite(wanted_of(worse, at_rest()).thrust));
}

TEST(SetPoints, APositionIsReachedAndHeldWithTheHeadingThatWasAsked) {
  SetPositionTargetLocalNed target;
  target.x = 3.0f, target.y = -2.0f, target.z = -1.5f, target.yaw = 0.8f;
  target.coordinate_frame = 1;
  target.type_mask = 56 | 448 | 2048;
  const Known is = after(8.0, target);
  EXPECT_LT((is.place.p_EB - Eigen::Vector3d{3, -2, -1.5}).norm(), 0.05);
  EXPECT_LT(is.place.v_E.norm(), 0.05);
  EXPECT_NEAR(is.attitude.yaw, 0.8, 0.02);
}

TEST(SetPoints, AVelocityIsThatOfTheEarthOrOfTheHeading) {
  const SetPositionTargetLocalNed north = mavlink::velocity_target({}, {1.5, 0, -0.5}, 0.6, {});
  EXPECT_LT((after(5.0, north).place.v_E - Eigen::Vector3d{1.5, 0, -0.5}).norm(), 0.05);
  SetPositionTargetLocalNed ahead = north;
  ahead.coordinate_frame = 8;
  ahead.type_mask |= 1024;
  const Known east = after(5.0, ahead, at_rest(kPi / 2));
  EXPECT_LT((east.place.v_E - Eigen::Vector3d{0, 1.5, -0.5}).norm(), 0.05);
}

TEST(SetPoints, AnAxisOfTheHeadingThatIsIgnoredIsNotBraked) {
  SetPositionTargetLocalNed ahead = mavlink::velocity_target({}, {1.5, 0, 0}, 0.0, {});
  ahead.coordinate_frame = 8;
  ahead.type_mask |= 1024 | 16;  // the heading, and the velocity to the right
  Known is = at_rest(kPi / 2);
  is.place.v_E = {-1.0, 0, 0};  // to the right
  const Known then = after(4.0, ahead, is);
  EXPECT_NEAR(then.place.v_E.y(), 1.5, 0.05);
  EXPECT_NEAR(then.place.v_E.x(), -1.0, 0.2);
}

TEST(SetPoints, AnAccelerationAloneIsNotBraked) {
  SetPositionTargetLocalNed target;
  target.afx = 1.0f;
  target.type_mask = 7 | 56 | 1024 | 2048;
  const Known is = after(2.0, target);
  EXPECT_NEAR(is.place.v_E.x(), 2.0, 0.2);
}

}  // namespace
}  // namespace gatefly::link_sim
