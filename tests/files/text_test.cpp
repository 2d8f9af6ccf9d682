// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/text.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace gatefly::files {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Fixed, HasSoManyDigitsAfterThePoint) {
  EXPECT_EQ(fixed(0.4866, 3), "0.487");
  EXPECT_EQ(fixed(-2.0, 1), "-2.0");
  EXPECT_EQ(fixed(1e6, 0), "1000000");
}

TEST(Fixed, ShowsADashForWhatIsNoNumber) {
  for (const double value : {kNan, kInfinity, -kInfinity}) EXPECT_EQ(fixed(value, 2), "-");
}

TEST(TextOf, IsTheShortestThatReadsBackTheSame) {
  EXPECT_EQ(text_of(0.1), "0.1");
  EXPECT_EQ(text_of(1e6), "1000000");
  EXPECT_EQ(text_of(1.0 / 3.0, 3), "0.333");
  EXPECT_EQ(text_of(kNan), "nan");
}

}  // namespace
}  // namespace gatefly::files
