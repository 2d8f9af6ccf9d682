// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/divisor.hpp"

#include <gtest/gtest.h>

namespace {

using gatefly::Divisor;

// A quotient grows only at multiples of the divisor: right on both sides of each, it is right everywhere.
TEST(Divisor, DividesAsTheProcessorDoes) {
  constexpr int kMost = 65535;
  for (int by = 1; by <= kMost; by += by < 600 ? 1 : 97) {
    const Divisor divided{by};
    for (int multiple = 0; multiple <= kMost; multiple += by) {
      ASSERT_EQ(divided(multiple), multiple / by) << multiple << " / " << by;
      if (multiple > 0) {
        ASSERT_EQ(divided(multiple - 1), (multiple - 1) / by);
      }
    }
    ASSERT_EQ(divided(kMost), kMost / by);
  }
}

}  // namespace
