// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/refined_side.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "support/for_all.hpp"

namespace gatefly::refinement {
namespace {

using namespace test;
using Eigen::Vector2d;

Vector2d any_point(Rng& rng) { return {rng.uniform(-50, 350), rng.uniform(-50, 250)}; }

/// The ends of a side that is some pixels long, in any direction.
std::pair<Vector2d, Vector2d> any_ends(Rng& rng) {
  const Vector2d a = any_point(rng);
  const double angle = rng.uniform(-4, 4), length = rng.uniform(10, 200);
  return {a, a + length * Vector2d{std::cos(angle), std::sin(angle)}};
}

Vector2d normal_of(const Vector2d& a, const Vector2d& b) {
  return Vector2d{a.y() - b.y(), b.x() - a.x()}.normalized();
}

TEST(Side, GoesThroughBothEndsAndIsNeverSteep) {
  for_all(200, [](Rng& rng) {
    const auto [a, b] = any_ends(rng);
    const Side side{a, b};
    EXPECT_EQ(side.level, std::abs(b.x() - a.x()) > std::abs(b.y() - a.y()));
    EXPECT_LE(std::abs(side.slope), 1.0 + 1e-9);
    for (const Vector2d& p : {a, b, Vector2d{0.5 * (a + b)}})
      EXPECT_LT((side.at(side.along(p)) - p).norm(), 1e-9);
  });
}

TEST(Side, BentStaysOnItsCornersAndLeavesTheChordByTheSag) {
  for_all(200, [](Rng& rng) {
    const auto [a, b] = any_ends(rng);
    const double sag = rng.uniform(-0.1, 0.1) * (b - a).norm();
    Side side{a, b};
    side.bend(a, b, sag * normal_of(a, b));
    EXPECT_LT((side.at(side.along(a)) - a).norm(), 1e-6);
    EXPECT_LT((side.at(side.along(b)) - b).norm(), 1e-6);
    const Vector2d middle = side.at(0.5 * (side.along(a) + side.along(b)));
    EXPECT_NEAR((middle - a).dot(normal_of(a, b)), sag, 1e-6);
  });
}

TEST(Side, ItsTangentTouchesIt) {
  for_all(100, [](Rng& rng) {
    const auto [a, b] = any_ends(rng);
    Side side{a, b};
    side.bend(a, b, rng.uniform(-8, 8) * normal_of(a, b));
    const double y = rng.uniform(side.along(a), side.along(b));
    const Side line = side.tangent(y);
    EXPECT_EQ(line.curve, 0.0);
    EXPECT_EQ(line.level, side.level);
    EXPECT_NEAR(line.x(y), side.x(y), 1e-6);
    // A parabola and its tangent part by the square of the distance.
    for (const double off : {-3.0, 2.0})
      EXPECT_NEAR(side.x(y + off) - line.x(y + off), side.curve * off * off, 1e-6);
  });
}

TEST(Side, LeanLikeAnotherKeepsItsPlaceAndItsBend) {
  for_all(100, [](Rng& rng) {
    const auto [a, b] = any_ends(rng);
    const auto [c, d] = any_ends(rng);
    Side side{a, b}, other{c, d};
    side.bend(a, b, 3.0 * normal_of(a, b)), other.bend(c, d, -2.0 * normal_of(c, d));
    const double y = side.middle, before = side.x(y), curve = side.curve;
    side.lean_like(other, y);
    EXPECT_NEAR(side.lean(), other.lean(), 1e-9);
    EXPECT_NEAR(side.x(y), before, 1e-6);
    EXPECT_EQ(side.curve, curve);
  });
}

TEST(Side, ItsEquationHoldsOnIt) {
  for_all(100, [](Rng& rng) {
    const auto [a, b] = any_ends(rng);
    const Eigen::Vector3d e = Side{a, b}.equation();
    EXPECT_NEAR(e.head<2>().dot(a), e[2], 1e-6);
    EXPECT_NEAR(e.head<2>().dot(b), e[2], 1e-6);
  });
}

TEST(Crossing, IsTheCornerThatTwoSidesShare) {
  int met = 0;
  for_all(200, [&](Rng& rng) {
    const auto [a, b] = any_ends(rng);
    const Vector2d c = any_point(rng), d = b - a, e = c - b;
    const double sine = std::abs(d.x() * e.y() - d.y() * e.x()) / (d.norm() * e.norm());
    const auto corner = crossing(Side{a, b}, Side{b, c});
    if (sine > 0.21) {
      ASSERT_TRUE(corner);
      EXPECT_LT((*corner - b).norm(), 1e-6);
      ++met;
    } else if (sine < 0.19) {
      EXPECT_FALSE(corner) << "nearly parallel";
    }
  });
  EXPECT_GT(met, 100);
}

TEST(Side, OfOnePointIsFiniteAndCrossesNothingParallel) {
  const Side none{{5, 5}, {5, 5}}, upright{{5, 5}, {5, 50}}, beside{{9, 5}, {9, 50}};
  EXPECT_TRUE(std::isfinite(none.slope) && std::isfinite(none.at_0));
  EXPECT_FALSE(crossing(upright, beside));
}

TEST(Curvature, IsAddedWithItsStraightPartTakenOff) {
  const Curvature curvature{.part = -400.0, .y_part = 50.0};
  Side side{{10, 0}, {20, 100}};
  const Side before = side;
  curvature.add_to(side, 0.002);
  for (const double y : {0.0, 30.0, 100.0})
    EXPECT_NEAR(side.x(y) - before.x(y), 0.002 * (y * y - 50.0 * y + 400.0), 1e-9) << y;
}

}  // namespace
}  // namespace gatefly::refinement
