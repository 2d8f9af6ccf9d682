// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/rng.hpp"

#include <array>
#include <limits>

#include <gtest/gtest.h>

namespace gatefly {
namespace {

TEST(Rng, GivesTheSequenceOfSplitMix64) {
  // Reference outputs for seed 1234567 (Vigna's splitmix64.c).
  Rng rng{1234567};
  EXPECT_EQ(rng.next(), 6457827717110365317ull);
  EXPECT_EQ(rng.next(), 3203168211198807973ull);
  EXPECT_EQ(rng.next(), 9817491932198370423ull);
}

TEST(Rng, SameSeedSameNumbersOtherSeedOtherNumbers) {
  Rng a{7}, b{7}, c{8};
  int same = 0;
  for (int i = 0; i < 100; ++i) {
    const auto x = a.next();
    EXPECT_EQ(x, b.next());
    same += x == c.next();
  }
  EXPECT_EQ(same, 0);
}

TEST(Rng, IndicesStayInRangeAndFillItEvenly) {
  Rng rng{3};
  std::array<int, 7> count{};
  constexpr int kTrials = 70'000;
  for (int i = 0; i < kTrials; ++i) {
    const int k = rng.uniform_index(7);
    ASSERT_GE(k, 0);
    ASSERT_LT(k, 7);
    ++count[static_cast<std::size_t>(k)];
  }
  double chi2 = 0;
  for (const int n : count) chi2 += (n - 1e4) * (n - 1e4) / 1e4;
  EXPECT_LT(chi2, 22.5) << "chi² with 6 degrees of freedom, 0.999";
}

TEST(Rng, NastyCountsGiveZero) {
  Rng rng{1};
  EXPECT_EQ(rng.uniform_index(0), 0);
  EXPECT_EQ(rng.uniform_index(-5), 0);
  EXPECT_EQ(rng.uniform_index(1), 0);
  EXPECT_GE(rng.uniform_index(std::numeric_limits<int>::max()), 0);
}

TEST(Rng, RealNumbersHaveTheMeanAndVarianceOfAUniformOne) {
  Rng rng{5};
  constexpr int kTrials = 100'000;
  double sum = 0, squares = 0;
  for (int i = 0; i < kTrials; ++i) {
    const double x = rng.uniform(-2, 4);
    ASSERT_GE(x, -2);
    ASSERT_LT(x, 4);
    sum += x, squares += (x - 1) * (x - 1);
  }
  EXPECT_NEAR(sum / kTrials, 1.0, 4 * 1.732 / 316);
  EXPECT_NEAR(squares / kTrials, 3.0, 0.05);
}

}  // namespace
}  // namespace gatefly
