// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/quantile.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace gatefly::files {
namespace {

TEST(Quantile, InterpolatesBetweenSortedValues) {
  EXPECT_EQ(quantile(std::array{1.0, 2.0, 4.0}, 0.5), 2.0);
  EXPECT_EQ(quantile(std::array{1.0, 2.0}, 0.75), 1.75);
  EXPECT_EQ(quantile(std::array{3.0}, 0.9), 3.0);
  constexpr std::array kValues{1.0, 2.0, 3.0, 4.0};
  EXPECT_EQ(quantile(kValues, 0.0), 1.0);
  EXPECT_EQ(quantile(kValues, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(quantile(kValues, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile(kValues, 0.25), 1.75);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(NearestRank, IsOneOfTheValuesInWhateverOrderTheyCome) {
  EXPECT_EQ(nearest_rank({4.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_EQ(nearest_rank({4.0, 1.0, 2.0}, 0.7), 2.0);
  EXPECT_EQ(nearest_rank({4.0, 1.0, 2.0}, 0.8), 4.0);
  EXPECT_EQ(nearest_rank({7.0}, 0.05), 7.0);
  EXPECT_TRUE(std::isnan(nearest_rank({}, 0.5)));
}

}  // namespace
}  // namespace gatefly::files
