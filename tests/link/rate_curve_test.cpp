// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/rate_curve.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/link/throttle_curve.hpp"

#include "support/for_all.hpp"
#include "support/matchers.hpp"

namespace gatefly::msp {
namespace {

using test::for_all;
using test::IsNear;

/// The profile of the AI Grand Prix's physical qualifier.
RcTuning qualifier() {
  return {.roll_rc_rate = 55,
          .super_rate = {75, 75, 70},
          .throttle_mid = 54,
          .throttle_expo = 68,
          .yaw_rc_rate = 57,
          .pitch_rc_rate = 55,
          .throttle_limit_percent = 100,
          .rate_limit = {1998, 1998, 1998}};
}
const RxConfig kReceiver{.mid = 1500, .min_check = 1050};

RateCurve any_curve(Rng& rng) {
  RateCurve curve;
  if (rng.uniform_index(2) == 1) curve.type = RateCurve::Type::kActual;
  const bool actual = curve.type == RateCurve::Type::kActual;
  curve.rc_rate = 1 + rng.uniform_index(actual ? 100 : 255);
  curve.super_rate = rng.uniform_index(actual ? 200 : 100);
  curve.expo = rng.uniform_index(91);
  curve.limit_deg_per_s = 200 + rng.uniform_index(1799);
  curve.deadband = rng.uniform_index(33);
  return curve;
}

TEST(RateCurve, TheQualifiersTurns440AtFullStickAnd88AtHalf) {
  const auto profile = RateProfile::from(qualifier(), {}, kReceiver);
  ASSERT_TRUE(profile);
  EXPECT_NEAR(profile->roll.rate(2000) / kDegree, 440, 1e-9);
  EXPECT_NEAR(profile->pitch.rate(1000) / kDegree, -440, 1e-9);
  EXPECT_NEAR(profile->roll.rate(1750) / kDegree, 88, 1e-9);
  EXPECT_NEAR(profile->yaw.rate(2000) / kDegree, 380, 1e-9);
  EXPECT_EQ(profile->roll.rate(1500), 0.0);
}

TEST(RateCurve, AStraightLineOfActualRates) {
  const RateCurve curve{.type = RateCurve::Type::kActual, .rc_rate = 40, .super_rate = 40};
  for (int stick = 1000; stick <= 2000; stick += 50)
    EXPECT_NEAR(curve.rate(stick) / kDegree, 0.8 * (stick - 1500), 1e-9);
}

TEST(RateCurve, ExpoMakesTheMiddleSoftAndLeavesTheEnds) {
  RateCurve curve{.rc_rate = 100, .super_rate = 0, .expo = 50};
  EXPECT_NEAR(curve.rate(2000) / kDegree, 200, 1e-9);
  EXPECT_NEAR(curve.rate(1750) / kDegree, 200 * (0.5 * 0.5 + 0.0625 * 0.5), 1e-9);
  curve.rc_rate = 250;  // beyond 2 it counts 15.54 times
  EXPECT_NEAR(curve.rate(1505) / kDegree, 200 * (2.5 + 14.54 * 0.5) * 0.01 * 0.5, 1e-3);
}

TEST(RateCurve, EveryStickComesBackFromItsRateToTheCount) {
  const auto profile = RateProfile::from(qualifier(), {}, kReceiver);
  ASSERT_TRUE(profile);
  for (const RateCurve& curve : {profile->roll, profile->pitch, profile->yaw})
    for (int stick = 1000; stick <= 2000; ++stick) EXPECT_EQ(curve.stick(curve.rate(stick)), stick);
}

TEST(RateCurve, WhereACurveRisesEverySticksComesBackAndElsewhereItsRateDoes) {
  for_all(200, [](Rng& rng) {
    const RateCurve curve = any_curve(rng);
    for (int stick = 1001; stick < 2000; ++stick) {
      const double rate = curve.rate(stick);
      EXPECT_EQ(curve.rate(curve.stick(rate)), rate) << stick;
      const bool rises = curve.rate(stick - 1) < rate && rate < curve.rate(stick + 1);
      EXPECT_TRUE(!rises || curve.stick(rate) == stick) << stick;
    }
  });
}

TEST(RateCurve, IsOddAndNeverFalls) {
  for_all(200, [](Rng& rng) {
    const RateCurve curve = any_curve(rng);
    for (int away = 1; away <= 500; ++away) {
      EXPECT_EQ(curve.rate(1500 + away), -curve.rate(1500 - away));
      EXPECT_GE(curve.rate(1500 + away), curve.rate(1499 + away)) << away;
    }
  });
}

TEST(RateCurve, TheStickIsTheNearestOfAll) {
  for_all(200, [](Rng& rng) {
    const RateCurve curve = any_curve(rng);
    const double wanted = rng.uniform(-10, 10);
    const double off = std::abs(curve.rate(curve.stick(wanted)) - wanted);
    for (int stick = 1000; stick <= 2000; ++stick)
      EXPECT_LE(off, std::abs(curve.rate(stick) - wanted)) << stick;
  });
}

TEST(RateCurve, WhatIsNoNumberIsTheMiddleAndWhatIsOutOfReachTheEnd) {
  const RateCurve curve{.rc_rate = 55, .super_rate = 75};
  EXPECT_EQ(curve.stick(std::numeric_limits<double>::quiet_NaN()), 1500);
  EXPECT_EQ(curve.stick(std::numeric_limits<double>::infinity()), 1500);
  EXPECT_EQ(curve.stick(1e9), 2000);
  EXPECT_EQ(curve.stick(-1e9), 1000);
  EXPECT_EQ(curve.stick(0.0), 1500);
}

TEST(RateCurve, RatesOfAnotherTypeAreNotGuessed) {
  RcTuning tuning = qualifier();
  for (const int type : {1, 2, 4, 77}) {
    tuning.rates_type = static_cast<std::uint8_t>(type);
    EXPECT_FALSE(RateProfile::from(tuning, {}, kReceiver)) << type;
  }
  EXPECT_FALSE(RateProfile::from(qualifier(), {}, {.mid = 0}));
  tuning = qualifier();
  tuning.pitch_expo = 101;
  EXPECT_FALSE(RateProfile::from(tuning, {}, kReceiver));
  tuning = qualifier();
  tuning.rate_limit[2] = 0;
  EXPECT_FALSE(RateProfile::from(tuning, {}, kReceiver));
}

TEST(RateProfile, ARateThatRaisesTheNosePullsThePitchStickBack) {
  const auto profile = RateProfile::from(qualifier(), {}, kReceiver);
  ASSERT_TRUE(profile);
  const Sticks sticks = profile->sticks({1.0, 1.0, 1.0});
  EXPECT_GT(sticks.roll, 1500);
  EXPECT_LT(sticks.pitch, 1500);
  EXPECT_GT(sticks.yaw, 1500);
  EXPECT_EQ(sticks.throttle, 1000);
  EXPECT_THAT(profile->rates(sticks), IsNear(Eigen::Vector3d(1, 1, 1), 0.01));
}

/// Figures worked out by hand from the documented formula.
TEST(ThrottleCurve, TheQualifiersIsFlatAboutItsMiddle) {
  const auto curve = ThrottleCurve::from(qualifier(), kReceiver);
  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->throttle(1000), 0);
  EXPECT_EQ(curve->throttle(1050), 0);
  EXPECT_EQ(curve->throttle(2000), 1000);
  // Stick 50 %: d = −4, 32 + 68 · 16 / 54² = 32, 540 − 4 · 32 / 10 = 528.
  EXPECT_EQ(curve->throttle(1525), 528);
  // 10 %: d = −44, 32 + 68 · 1936 / 2916 = 77, 540 − 338 = 202.
  EXPECT_EQ(curve->throttle(1145), 202);
}

TEST(ThrottleCurve, NeverFallsAndComesBackToTheThrottleThatWasAskedFor) {
  for_all(200, [](Rng& rng) {
    RcTuning tuning = qualifier();
    tuning.throttle_mid = static_cast<std::uint8_t>(rng.uniform_index(101));
    tuning.throttle_expo = static_cast<std::uint8_t>(rng.uniform_index(101));
    RxConfig receiver = kReceiver;
    receiver.min_check = static_cast<std::uint16_t>(1000 + rng.uniform_index(200));
    const auto curve = ThrottleCurve::from(tuning, receiver);
    ASSERT_TRUE(curve);
    EXPECT_NEAR(curve->throttle(receiver.min_check), 0, 10);
    EXPECT_NEAR(curve->throttle(2000), 1000, 10);
    for (int stick = 1001; stick <= 2000; ++stick) {
      EXPECT_LE(curve->throttle(stick - 1), curve->throttle(stick));
      const int back = curve->stick(curve->throttle(stick));
      EXPECT_EQ(curve->throttle(back), curve->throttle(stick));
      EXPECT_LE(back, std::max<int>(stick, receiver.min_check))
          << "the least of those that give it";
    }
  });
}

TEST(ThrottleCurve, ALinearOneComesBackToTheCount) {
  RcTuning tuning = qualifier();
  tuning.throttle_mid = 50, tuning.throttle_expo = 0;
  const auto curve = ThrottleCurve::from(tuning, {.mid = 1500, .min_check = 1000});
  ASSERT_TRUE(curve);
  for (int stick = 1000; stick <= 2000; ++stick) {
    EXPECT_EQ(curve->throttle(stick), stick - 1000);
    EXPECT_EQ(curve->stick(stick - 1000), stick);
  }
}

TEST(ThrottleCurve, AnotherCurveOrALimitIsNotGuessed) {
  RcTuning tuning = qualifier();
  tuning.throttle_hover = 30;
  EXPECT_FALSE(ThrottleCurve::from(tuning, kReceiver));
  tuning = qualifier();
  tuning.throttle_limit = 1;
  EXPECT_FALSE(ThrottleCurve::from(tuning, kReceiver));
  EXPECT_FALSE(ThrottleCurve::from(qualifier(), {.min_check = 2000}));
}

}  // namespace
}  // namespace gatefly::msp
