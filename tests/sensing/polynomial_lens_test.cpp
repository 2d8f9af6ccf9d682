// SPDX-License-Identifier: Apache-2.0
// Brown-Conrady and Kannala-Brandt: what every lens must do is in camera_test.cpp.
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sensing/camera.hpp"

#include "support/for_all.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;
using Eigen::Vector3d;

using Coefficients = RadialPolynomial::Coefficients;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Barrels, pincushions, one that folds back inside the picture, ones whose slope wiggles.
std::vector<Coefficients> nasty_radials() {
  return {{0, 0, 0, 0},
          {-0.32157, 0.10421, -0.01501, 0},
          {-0.5, 0, 0, 0},
          {-0.9, 0.4, -0.1, 0},
          {0.3, 0.1, 0, 0},
          {-1, 1, -0.5, 0.1},
          {5, -30, 100, 0},
          {-40, 0, 0, 0},
          {-0.2, -0.1, 0.05, -0.02},
          {1e-9, -1e-9, 1e-9, 0},
          {0.05, -0.012, 0.006, -0.0015},
          {-1.0 / 3.0, 0, 0, 0}};
}

std::vector<Vector2d> tangentials() { return {{0, 0}, {0.001, -0.002}, {-0.05, 0.03}}; }

/// All lenses to torment, around the middle of a 315 x 160 picture.
std::vector<AnyCamera> nasty_lenses() {
  std::vector<AnyCamera> lenses;
  for (const Coefficients& k : nasty_radials()) {
    lenses.push_back({KannalaBrandt{{169, 171}, {150, 85}, RadialPolynomial{k}}});
    for (const Vector2d& p : tangentials())
      lenses.push_back({BrownConrady{{169, 171}, {150, 85}, {k[0], k[1], p.x(), p.y(), k[2]}}});
  }
  return lenses;
}

/// Runs `look(px)` on every second pixel of a picture, its border included.
template <class Look>
void over_the_picture(Look&& look) {
  for (int v = 0; v < 160; v += 2)
    for (int u = 0; u < 315; u += 2) look(Vector2d(u, v));
}

TEST(NastyLens, ProjectUndoesBearingWhereverThePictureShowsSomething) {
  const auto lenses = nasty_lenses();
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    SCOPED_TRACE(i);
    int shown = 0;
    over_the_picture([&](const Vector2d& px) {
      const auto bearing = lenses[i].bearing(px);
      if (!bearing) return;
      ++shown;
      ASSERT_NEAR(bearing->norm(), 1.0, 1e-14);
      const auto back = lenses[i].project(3.7 * *bearing);
      ASSERT_TRUE(back) << px.transpose();
      ASSERT_THAT(*back, IsNear(px, 1e-8));
    });
    EXPECT_GT(shown, 20) << "the middle of the picture shows always";
  }
}

TEST(NastyLens, WhatProjectShowsBearingFindsAgain) {
  const auto lenses = nasty_lenses();
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    SCOPED_TRACE(i);
    for_all(300, [&](Rng& rng) {
      const double reach = std::pow(10.0, rng.uniform(-2.5, 0.5));  // some see but a narrow cone
      const Vector3d p{rng.uniform(-reach, reach), rng.uniform(-reach, reach), rng.uniform(0.5, 5)};
      const auto px = lenses[i].project(p);
      if (!px) return not_a_case();
      const auto bearing = lenses[i].bearing(*px);
      ASSERT_TRUE(bearing) << p.transpose();
      // At the fold a pixel is many directions wide: what must agree is the picture.
      ASSERT_THAT(*lenses[i].project(*bearing), IsNear(*px, 1e-8 + 1e-13 * px->norm()));
    });
  }
}

TEST(PolynomialLens, BearingAfterProjectIsTheDirectionAwayFromTheFold) {
  const RadialPolynomial wide{{0.05, -0.012, 0.006, -0.0015}};
  const std::vector<AnyCamera> lenses{
      {BrownConrady{{169, 171}, {150, 85}, {-0.32157, 0.10421, 0, 0, -0.01501}}},
      {BrownConrady{{169, 171}, {150, 85}, {-0.32157, 0.10421, 0.002, -0.003, -0.01501}}},
      {KannalaBrandt{{169, 171}, {150, 85}, wide}}};
  for (const AnyCamera& lens : lenses) {
    for_all(300, [&](Rng& rng) {
      const double off_axis = rng.uniform(0, 55) * kDegree, turn = rng.uniform(0, 2 * kPi);
      const Vector3d p{std::sin(off_axis) * std::cos(turn), std::sin(off_axis) * std::sin(turn),
                       std::cos(off_axis)};
      const auto px = lens.project(rng.uniform(0.1, 20) * p);
      ASSERT_TRUE(px);
      const auto bearing = lens.bearing(*px);
      ASSERT_TRUE(bearing);
      EXPECT_THAT(*bearing, IsNear(p, 1e-11));
    });
  }
}

TEST(RadialPolynomial, LimitIsWhereTheSlopeIsZero) {
  // By hand: 1 + 3 k1 r² = 0.
  EXPECT_NEAR(RadialPolynomial({-1.0 / 3, 0, 0, 0}).limit(), 1.0, 1e-15);
  EXPECT_NEAR(RadialPolynomial({-0.5, 0, 0, 0}).limit(), std::sqrt(2.0 / 3.0), 1e-15);
  // 1 - 3 s + 2 s² (k2 = 2/5) is zero at s = 1/2 first, at 1 again.
  EXPECT_NEAR(RadialPolynomial({-1.0, 0.4, 0, 0}).limit(), std::sqrt(0.5), 1e-14);
  // (1 - s/4)(1 + s²)(1 + s) = 1 + 3/4 s + 3/4 s² + 3/4 s³ - 1/4 s⁴
  EXPECT_NEAR(RadialPolynomial({0.25, 0.15, 0.75 / 7, -0.25 / 9}).limit(), 2.0, 1e-13);
  EXPECT_EQ(RadialPolynomial({0, 0, 0, 0}).limit(), 1e6);
  EXPECT_EQ(RadialPolynomial({0.3, 0.1, 0, 0}).limit(), 1e6);
  // 1 - 2 r is zero at 1/2.
  EXPECT_NEAR(RadialPolynomial({0, 0, 0, 0}, 2.0).limit(), 0.5, 1e-15);
  EXPECT_EQ(RadialPolynomial({kNan, 0, 0, 0}).limit(), 0.0);
}

TEST(RadialPolynomial, GrowsStrictlyUpToItsLimitWhateverTheCoefficients) {
  for_all(500, [](Rng& rng) {
    const double size = std::pow(10.0, rng.uniform(-3, 3));
    const auto any = [&] { return rng.uniform(-size, size); };
    const RadialPolynomial g{{any(), any(), any(), any()}};
    const double end = std::min(g.limit(), 5.0);
    for (int i = 1; i < 1000; ++i)
      ASSERT_GT(g(end * (i + 1) / 1000), g(end * i / 1000))
          << "limit " << g.limit() << " at " << end * i / 1000;
    if (g.limit() < 1e6) {
      EXPECT_LE(g(g.limit() * 1.001), g(g.limit())) << "it folds back there";
    }
  });
}

TEST(RadialPolynomial, InverseUndoesItUpToTheLimitAndStopsThere) {
  for_all(500, [](Rng& rng) {
    const double size = std::pow(10.0, rng.uniform(-3, 3));
    const auto any = [&] { return rng.uniform(-size, size); };
    const RadialPolynomial g{{any(), any(), any(), any()}};
    const double value = g(rng.uniform(0, 0.9999) * std::min(g.limit(), 5.0));
    const auto r = g.inverse(value);
    ASSERT_TRUE(r);
    EXPECT_LE(*r, g.limit());
    EXPECT_NEAR(g(*r), value, 1e-13 * (1.0 + value) * (1.0 + size));
    EXPECT_FALSE(g.inverse(1.001 * g(g.limit())));
    EXPECT_FALSE(g.inverse(-0.1));
    EXPECT_FALSE(g.inverse(kNan));
  });
}

// The documented formulas of OpenCV's calib3d and fisheye modules, worked out in 50-digit decimals
// (Python's decimal) with no code in common: focal (500, 510), centre (320, 240),
// k1 -0.28, k2 0.07, p1 0.0012, p2 -0.0007, k3 0.004.
TEST(BrownConrady, DrawsWhereOpenCvsFormulaDoes) {
  const BrownConrady lens{{500, 510}, {320, 240}, {-0.28, 0.07, 0.0012, -0.0007, 0.004}};
  EXPECT_THAT(*lens.project({0.3, -0.2, 1.0}), IsNear(Vector2d{464.5382682, 141.762597624}, 1e-10));
  EXPECT_THAT(*lens.project({1.0, 0.5, 2.0}),
              IsNear(Vector2d{549.730126953125, 357.4093959960937}, 1e-10));
  EXPECT_THAT(*lens.project({-1.2, 0.9, 1.5}), IsNear(Vector2d{1.026, 484.35936}, 1e-10));
}

// The same for the fisheye: focal (280, 281), centre (320, 240), k 0.05, -0.012, 0.006, -0.0015.
TEST(KannalaBrandt, DrawsWhereOpenCvsFormulaDoes) {
  const KannalaBrandt lens{
      {280, 281}, {320, 240}, RadialPolynomial{{0.05, -0.012, 0.006, -0.0015}}};
  EXPECT_THAT(*lens.project({0.3, -0.2, 1.0}),
              IsNear(Vector2d{401.0896050749542, 185.7471927950902}, 1e-10));
  EXPECT_THAT(*lens.project({1.0, 0.5, 2.0}),
              IsNear(Vector2d{449.2266577923763, 304.8440907851031}, 1e-10));
  EXPECT_THAT(*lens.project({-1.2, 0.9, 1.5}),
              IsNear(Vector2d{139.2384636873847, 376.0553349210131}, 1e-10));
}

TEST(BrownConrady, WorkedOutByHand) {
  // (x, y) = (1, 0): a = 1 - 0.1 + 0.02 - 0.003 = 0.917; the shift is (3 p2, p1).
  const BrownConrady lens{{100, 200}, {10, 20}, {-0.1, 0.02, 0.01, 0.02, -0.003}};
  EXPECT_THAT(*lens.project({2, 0, 2}), IsNear(Vector2d{10 + 97.7, 20 + 2.0}, 1e-12));
}

TEST(BrownConrady, WithoutDistortionIsThePinhole) {
  const Pinhole pinhole;
  const BrownConrady lens;
  for_all(200, [&](Rng& rng) {
    const Vector3d p{rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(0.1, 5)};
    EXPECT_THAT(*lens.project(p), IsNear(*pinhole.project(p), 1e-10));
    const Vector2d px{rng.uniform(-500, 800), rng.uniform(-500, 600)};
    EXPECT_THAT(*lens.bearing(px), IsNear(*pinhole.bearing(px), 1e-15));
  });
}

TEST(KannalaBrandt, WithoutDistortionIsEquidistant) {
  const KannalaBrandt lens;  // 168 px a radian
  const double slope = std::tan(0.7);
  EXPECT_THAT(*lens.project({0, -2 * slope, 2}), IsNear(Vector2d{157, 124 - 168 * 0.7}, 1e-10));
  EXPECT_THAT(*lens.bearing({157 + 168 * 1.2, 124}),
              IsNear(Vector3d{std::sin(1.2), 0, std::cos(1.2)}, 1e-14));
}

TEST(KannalaBrandt, SeesAlmostToNinetyDegreesAndNoFarther) {
  const KannalaBrandt lens;
  EXPECT_TRUE(lens.bearing({157 + 168 * (kPi / 2 - 1e-3), 124}));
  EXPECT_FALSE(lens.bearing({157 + 168 * (kPi / 2 + 1e-3), 124}));
  EXPECT_TRUE(lens.project({1, 0, 1e-3}));
  EXPECT_FALSE(lens.project({1, 0, -1e-3}));
}

TEST(BrownConrady, NothingShowsBeyondTheFold) {
  // g(r) = r - r³/3 grows up to r = 1, 45° from the axis, drawn at 2/3 of the focal length.
  const BrownConrady lens{{100, 100}, {0, 0}, {-1.0 / 3, 0, 0, 0, 0}};
  EXPECT_TRUE(lens.project({0.999, 0, 1}));
  EXPECT_FALSE(lens.project({1.001, 0, 1}));
  EXPECT_FALSE(lens.project({1.7, 0, 1})) << "it would show near the centre";
  EXPECT_FALSE(lens.project({50, 0, 1}));
  EXPECT_TRUE(lens.bearing({66.6, 0}));
  EXPECT_FALSE(lens.bearing({66.7, 0}));
  EXPECT_FALSE(lens.bearing({1e9, 1e9}));
}

TEST(KannalaBrandt, NothingShowsBeyondTheFold) {
  // up to 1 rad
  const KannalaBrandt lens{{100, 100}, {0, 0}, RadialPolynomial{{-1.0 / 3, 0, 0, 0}}};
  EXPECT_TRUE(lens.project({std::tan(0.999), 0, 1}));
  EXPECT_FALSE(lens.project({std::tan(1.001), 0, 1}));
  EXPECT_TRUE(lens.bearing({0, 66.6}));
  EXPECT_FALSE(lens.bearing({0, 66.7}));
}

TEST(BrownConrady, TheBebopsCalibrationEndsSixtyDegreesFromTheAxis) {
  const BrownConrady lens{
      {169.229, 169.453}, {149.328, 124.100}, {-0.32157, 0.10421, 0, 0, -0.01501}};
  // First sign change of the slope on a grid of 1e-5 in r², halved: 1.713446764252413 (59.7°),
  // drawn at 0.98403 f.
  EXPECT_NEAR(lens.limit(), 1.713446764252413, 1e-12);
  EXPECT_TRUE(lens.bearing({0, 124})) << "the left border";
  EXPECT_TRUE(lens.bearing({314, 124})) << "the right border";
  EXPECT_FALSE(lens.bearing({0, 0})) << "the far corner";
}

TEST(PolynomialLens, CoefficientsThatAreNotNumbersShowNothing) {
  for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
    const RadialPolynomial radial{{bad, 0, 0, 0}};
    const std::vector<AnyCamera> lenses{{BrownConrady{{100, 100}, {0, 0}, {0, bad, 0, 0, 0}}},
                                        {BrownConrady{{100, 100}, {0, 0}, {0, 0, bad, 0, 0}}},
                                        {KannalaBrandt{{100, 100}, {0, 0}, radial}}};
    for (const AnyCamera& lens : lenses) {
      EXPECT_FALSE(lens.project({0.1, 0.1, 1}));
      EXPECT_FALSE(lens.bearing({3, 4}));
    }
  }
}

TEST(VanishingPoint, IsWhereAStraightLensOfTheSameFocalLengthDrawsTheDirection) {
  const RadialPolynomial radial{{-0.3, 0.1, 0, 0}};
  const std::vector<AnyCamera> lenses{{BrownConrady{{100, 110}, {50, 60}, {-0.3, 0.1, 0, 0, 0}}},
                                      {KannalaBrandt{{100, 110}, {50, 60}, radial}}};
  for (const AnyCamera& lens : lenses) {
    const auto px = vanishing_point_px(lens, {1, 2, 0.5});
    ASSERT_TRUE(px);
    EXPECT_THAT(*px, IsNear(Vector2d{50 + 100 * 2.0, 60 + 110 * 4.0}, 0.1));
    EXPECT_FALSE(vanishing_point_px(lens, {1, 2, 0.01}));
  }
}

}  // namespace
}  // namespace gatefly
