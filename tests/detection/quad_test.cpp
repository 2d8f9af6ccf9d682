// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/quad.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;

Quad square_at(double u, double v, double side) {
  return {{{u, v}, {u + side, v}, {u + side, v + side}, {u, v + side}}};
}

Quad turned(const Quad& q, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Quad out;
  for (std::size_t i = 0; i < 4; ++i)
    out[i] = Vector2d{c * q[i].x() - s * q[i].y(), s * q[i].x() + c * q[i].y()};
  return out;
}

TEST(Quad, AreaIsPositiveClockwiseAsSeen) {
  EXPECT_DOUBLE_EQ(area(square_at(3, 4, 10)), 100);
  Quad other_way = square_at(3, 4, 10);
  std::swap(other_way[1], other_way[3]);
  EXPECT_DOUBLE_EQ(area(other_way), -100);
}

TEST(Quad, SharedAreaOfSquares) {
  const Quad a = square_at(0, 0, 10);
  EXPECT_NEAR(shared_area(a, a), 100, 1e-9);
  EXPECT_NEAR(shared_area(a, square_at(5, 5, 10)), 25, 1e-9);
  EXPECT_NEAR(shared_area(a, square_at(2, 2, 3)), 9, 1e-9);
  EXPECT_NEAR(shared_area(a, square_at(20, 0, 10)), 0, 1e-9);
  EXPECT_NEAR(shared_area(a, square_at(10, 0, 10)), 0, 1e-9) << "touching";
}

TEST(Quad, SharedAreaIsSymmetricBoundedAndTurnsWithThePicture) {
  for_all(200, [](Rng& rng) {
    const Quad a = turned(square_at(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(1, 20)),
                          rng.uniform(-3, 3));
    const Quad b = turned(square_at(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(1, 20)),
                          rng.uniform(-3, 3));
    const double shared = shared_area(a, b);
    EXPECT_NEAR(shared, shared_area(b, a), 1e-6);
    EXPECT_GE(shared, 0);
    EXPECT_LE(shared, std::min(area(a), area(b)) + 1e-6);
    EXPECT_NEAR(shared, shared_area(turned(a, 0.7), turned(b, 0.7)), 1e-6);
    Quad b_other_way = b;
    std::swap(b_other_way[1], b_other_way[3]);
    EXPECT_NEAR(shared, shared_area(a, b_other_way), 1e-6);
  });
}

TEST(Quad, OverlapsByThePartOfTheLargerThatBothShare) {
  const Quad a = square_at(0, 0, 10);
  EXPECT_TRUE(overlaps(a, a, 1.0));
  EXPECT_TRUE(overlaps(a, square_at(0, 3, 10), 0.7)) << "exactly 70 %";
  EXPECT_FALSE(overlaps(a, square_at(0, 3.01, 10), 0.7));
  EXPECT_FALSE(overlaps(a, square_at(1, 1, 8), 0.7)) << "covered, but of another size";
  EXPECT_FALSE(overlaps(square_at(1, 1, 8), a, 0.7));
  Quad other_way = a;
  std::swap(other_way[1], other_way[3]);
  EXPECT_TRUE(overlaps(a, other_way, 1.0));
}

TEST(Quad, APartOfAFrameIsInItsPlaceWhatStandsInItsOpeningIsNot) {
  const Quad gate = square_at(0, 0, 10);
  EXPECT_TRUE(same_place(gate, square_at(1, 1, 8))) << "the inner edge of its bars";
  EXPECT_TRUE(same_place(gate, square_at(0, 0, 5))) << "a post makes a frame of a part";
  EXPECT_FALSE(same_place(gate, square_at(3, 4, 3))) << "a gate behind it";
  EXPECT_FALSE(same_place(square_at(3, 4, 3), gate));
  EXPECT_FALSE(same_place(gate, square_at(9, 0, 10))) << "one beside it";
  EXPECT_TRUE(stands_within(square_at(3, 4, 3), gate));
  EXPECT_FALSE(stands_within(gate, square_at(3, 4, 3)));
}

TEST(Quad, CornersAreListedClockwiseFromTopLeftHoweverTheyCome) {
  const Quad wanted = square_at(10, 20, 30);
  for_all(200, [&](Rng& rng) {
    Quad shuffled = wanted;
    std::rotate(shuffled.begin(), shuffled.begin() + rng.uniform_index(4), shuffled.end());
    if (rng.uniform_index(2)) std::reverse(shuffled.begin(), shuffled.end());
    const Quad sorted = clockwise_from_top_left(shuffled);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(sorted[i], wanted[i]);
  });
}

TEST(Quad, KeepsItsTopLeftUnderRollOfThirtyDegrees) {
  for (double roll = -0.52; roll <= 0.53; roll += 0.04) {
    const Quad tilted = turned(square_at(-20, -20, 40), roll);
    EXPECT_EQ(clockwise_from_top_left(tilted)[0], tilted[0]) << roll;
  }
}

TEST(Quad, CenterIsTheMiddle) {
  EXPECT_THAT(center(square_at(0, 10, 4)), IsNear(Vector2d{2, 12}, 1e-12));
}

}  // namespace
}  // namespace gatefly
