// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/nearest_snake.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

#include "gatefly/geometry/rng.hpp"

namespace gatefly {
namespace {

using Numbers = std::array<std::int16_t, kMostSnakes>;

std::size_t plainly_nearest(const Numbers& expected, const Numbers& reach, int x) {
  std::size_t nearest = kMostSnakes;
  int least = kMostSnakeReach;
  for (std::size_t k = 0; k < kMostSnakes; ++k) {
    const int off = std::abs(x - expected[k]);
    if (off < reach[k] && off < least) least = off, nearest = k;
  }
  return nearest;
}

// Few and many snakes, near to each other and far apart, and as many equally near ones as there can
// be.
TEST(NearestSnake, IsTheFirstOfThoseNearestThatReach) {
  Rng rng{1};
  const auto up_to = [&](int most) {
    return static_cast<std::int16_t>(rng.uniform_index(most + 1));
  };
  int found = 0;
  for (int i = 0; i < 50'000; ++i) {
    const int spread = 1 << up_to(13), most_reach = 1 << up_to(9);
    Numbers expected, reach;
    for (std::size_t k = 0; k < kMostSnakes; ++k)
      expected[k] = up_to(spread), reach[k] = up_to(most_reach);
    const std::int16_t x = up_to(spread);
    const std::size_t nearest = nearest_snake(expected, reach, x);
    ASSERT_EQ(nearest, plainly_nearest(expected, reach, x)) << "case " << i;
    found += nearest < kMostSnakes;
  }
  EXPECT_GT(found, 10'000);
  EXPECT_LT(found, 49'000);
}

TEST(NearestSnake, NoneReachesWhereThereIsNone) {
  EXPECT_EQ(nearest_snake(Numbers{}, Numbers{}, 0), kMostSnakes);
}

}  // namespace
}  // namespace gatefly
