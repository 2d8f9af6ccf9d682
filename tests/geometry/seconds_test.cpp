// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/seconds.hpp"

#include <gtest/gtest.h>

namespace gatefly {
namespace {

using namespace std::chrono_literals;

TEST(Seconds, AreTheNumberThatTheirDecimalsName) {
  EXPECT_EQ(seconds(0ns), 0.0);
  EXPECT_EQ(seconds(-1500ms), -1.5);
  // 1e-9 * 2043706 is 0.0020437060000000002.
  EXPECT_EQ(seconds(2043706ns), 0.002043706);
}

}  // namespace
}  // namespace gatefly
