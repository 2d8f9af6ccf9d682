// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/math.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/for_all.hpp"

namespace gatefly {
namespace {

using test::for_all;

TEST(Math, SineAndCosineAgreeWithTheStandardLibrary) {
  for_all(200, [](Rng& rng) {
    for (const double size : {1e-3, 1.0, 10.0, 1e3, 9.9e4}) {
      const double a = rng.uniform(-size, size);
      EXPECT_NEAR(gatefly::sin(a), std::sin(a), 1e-14) << a;
      EXPECT_NEAR(gatefly::cos(a), std::cos(a), 1e-14) << a;
    }
  });
}

TEST(Math, SineAndCosineAreExactAtTheCorners) {
  EXPECT_EQ(gatefly::sin(0.0), 0.0);
  EXPECT_EQ(gatefly::cos(0.0), 1.0);
  for (int quarter = -8; quarter <= 8; ++quarter) {
    const double a = quarter * kPi / 4;
    EXPECT_NEAR(gatefly::sin(a), std::sin(a), 1e-15) << a;
    EXPECT_NEAR(gatefly::cos(a), std::cos(a), 1e-15) << a;
  }
}

TEST(Math, SinSquaredPlusCosSquaredIsOneAndSineIsOdd) {
  for_all(200, [](Rng& rng) {
    const double a = rng.uniform(-50, 50);
    const auto [s, c] = sincos(a);
    EXPECT_NEAR(s * s + c * c, 1.0, 4e-16);
    EXPECT_EQ(gatefly::sin(-a), -s);
    EXPECT_EQ(gatefly::cos(-a), c);
    EXPECT_NEAR(gatefly::tan(a), s / c, 1e-12 * std::abs(s / c));
  });
}

TEST(Math, Atan2AgreesWithTheStandardLibraryInAllQuadrants) {
  for_all(200, [](Rng& rng) {
    for (const double scale : {1e-6, 1.0, 1e6}) {
      const double y = rng.uniform(-1, 1) * scale, x = rng.uniform(-1, 1);
      EXPECT_NEAR(gatefly::atan2(y, x), std::atan2(y, x), 1e-14) << y << ", " << x;
      EXPECT_NEAR(gatefly::atan(y), std::atan(y), 1e-14) << y;
    }
    const double s = rng.uniform(-1, 1);
    EXPECT_NEAR(gatefly::asin(s), std::asin(s), 1e-14);
    EXPECT_NEAR(gatefly::acos(s), std::acos(s), 1e-14);
  });
}

TEST(Math, Atan2OnTheAxes) {
  EXPECT_EQ(gatefly::atan2(0, 0), 0.0);
  EXPECT_EQ(gatefly::atan2(0, 1), 0.0);
  EXPECT_DOUBLE_EQ(gatefly::atan2(1, 0), kPi / 2);
  EXPECT_DOUBLE_EQ(gatefly::atan2(-1, 0), -kPi / 2);
  EXPECT_DOUBLE_EQ(gatefly::atan2(0, -1), kPi);
  EXPECT_DOUBLE_EQ(gatefly::atan2(-0.0, -1), kPi) << "never -pi: the range is (-pi, pi]";
  EXPECT_DOUBLE_EQ(gatefly::atan(std::numeric_limits<double>::infinity()), kPi / 2);
}

TEST(Math, ArcSineForgivesRounding) {
  EXPECT_DOUBLE_EQ(gatefly::asin(1.0 + 1e-12), kPi / 2);
  EXPECT_DOUBLE_EQ(gatefly::asin(-1.0 - 1e-12), -kPi / 2);
  EXPECT_DOUBLE_EQ(gatefly::acos(1.0 + 1e-12), 0.0);
}

// Infinite, huge and undefined values must not pass for level.
TEST(Math, WhatIsNoAngleHasNoSine) {
  for (const double a :
       {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::quiet_NaN(), 1e300, -1e300}) {
    EXPECT_TRUE(std::isnan(gatefly::sin(a))) << a;
    EXPECT_TRUE(std::isnan(gatefly::cos(a))) << a;
  }
}

TEST(WrapAngle, AnswersTheSameDirectionInTheHalfOpenRange) {
  EXPECT_DOUBLE_EQ(wrap_angle(kPi), kPi);
  EXPECT_DOUBLE_EQ(wrap_angle(-kPi), kPi);
  EXPECT_DOUBLE_EQ(wrap_angle(0.0), 0.0);
  for_all(200, [](Rng& rng) {
    const double a = rng.uniform(-100, 100), w = wrap_angle(a);
    EXPECT_GT(w, -kPi);
    EXPECT_LE(w, kPi);
    EXPECT_NEAR(std::sin(w), std::sin(a), 1e-12);
    EXPECT_NEAR(std::cos(w), std::cos(a), 1e-12);
  });
}

}  // namespace
}  // namespace gatefly
