// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sensing/camera.hpp"

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
using Eigen::Vector2d;
using Eigen::Vector3d;

template <class Lens>
class EveryLens : public ::testing::Test {
 public:
  Lens lens;
};
using Lenses = ::testing::Types<Pinhole, DhaneFisheye, BrownConrady, KannalaBrandt, AnyCamera>;
TYPED_TEST_SUITE(EveryLens, Lenses);

TYPED_TEST(EveryLens, ProjectAfterBearingIsTheIdentity) {
  for_all(200, [&](Rng& rng) {
    const Vector2d px{rng.uniform(0, 315), rng.uniform(0, 160)};
    const auto bearing = this->lens.bearing(px);
    ASSERT_TRUE(bearing);
    EXPECT_NEAR(bearing->norm(), 1.0, 1e-14);
    const auto back = this->lens.project(rng.uniform(0.1, 20) * *bearing);
    ASSERT_TRUE(back);
    EXPECT_THAT(*back, IsNear(px, 1e-9));
  });
}

TYPED_TEST(EveryLens, BearingAfterProjectIsTheDirection) {
  for_all(200, [&](Rng& rng) {
    const Vector3d p{rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(0.5, 5)};
    const auto px = this->lens.project(p);
    ASSERT_TRUE(px);
    const auto bearing = this->lens.bearing(*px);
    ASSERT_TRUE(bearing);
    EXPECT_THAT(*bearing, IsNear(p.normalized(), 1e-12));
  });
}

TYPED_TEST(EveryLens, WhatIsBehindOrBesideDoesNotShow) {
  EXPECT_FALSE(this->lens.project({0, 0, -1}));
  EXPECT_FALSE(this->lens.project({0.1, 0.2, -3}));
  EXPECT_FALSE(this->lens.project({1, 0, 0}));
  EXPECT_FALSE(this->lens.project({0, 0, 0}));
}

TYPED_TEST(EveryLens, NonFiniteInputHasNoAnswer) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(this->lens.project({nan, 0, 1}));
  EXPECT_FALSE(this->lens.project({0, 0, inf}));
  EXPECT_FALSE(this->lens.bearing({nan, 0}));
  EXPECT_FALSE(this->lens.bearing({0, inf}));
}

TYPED_TEST(EveryLens, TheAxisShowsAtTheCentreAndRightIsRight) {
  const auto middle = this->lens.project({0, 0, 2});
  ASSERT_TRUE(middle);
  EXPECT_THAT(*middle, IsNear(Vector2d{157, 124}, 1e-12));
  EXPECT_THAT(*this->lens.bearing({157, 124}), IsNear(Vector3d{0, 0, 1}, 1e-15));
  EXPECT_GT(this->lens.project({0.1, 0, 2})->x(), 157);
  EXPECT_GT(this->lens.project({0, 0.1, 2})->y(), 124) << "down is down";
}

TEST(DhaneFisheye, FollowsTheFormulaAsPrinted) {
  const DhaneFisheye lens;
  const double f = 168;
  for_all(200, [&](Rng& rng) {
    const double r = rng.uniform(1, 180), turn = rng.uniform(0, 2 * kPi);
    const auto b = lens.bearing(lens.center_px + r * Vector2d{std::cos(turn), std::sin(turn)});
    ASSERT_TRUE(b);
    const double R = f * std::tan(std::asin(lens.k * std::sin(std::atan(r / f))));
    EXPECT_NEAR(f * b->template head<2>().norm() / b->z(), R, 1e-9 * R);
  });
}

TEST(DhaneFisheye, WithKOneIsThePinhole) {
  DhaneFisheye fisheye;
  fisheye.k = 1.0;
  const Pinhole pinhole;
  for_all(200, [&](Rng& rng) {
    const Vector3d p{rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(0.5, 5)};
    EXPECT_THAT(*fisheye.project(p), IsNear(*pinhole.project(p), 1e-9));
  });
}

TEST(DhaneFisheye, SeesNoFartherThanNinetyDegrees) {
  const DhaneFisheye lens;  // k sin(atan(r/f)) = 1 at r = 412 px
  EXPECT_TRUE(lens.bearing({157 + 405, 124}));
  EXPECT_FALSE(lens.bearing({157 + 420, 124}));
  EXPECT_FALSE(lens.bearing({1e9, 1e9}));
}

}  // namespace
}  // namespace gatefly
