// SPDX-License-Identifier: Apache-2.0
#include "gatefly/closed_loop/consistency.hpp"

#include <gtest/gtest.h>

#include "gatefly/sim/random.hpp"

namespace gatefly::closed_loop {
namespace {

// 20,000 draws: the mean within 4 standard errors of 1, 95 % within 4 standard errors inside.
TEST(ChiSquareCount, NormalErrorsAreAsExpected) {
  sim::Stream stream{1, "chi square"};
  for (const int dof : {1, 2, 3}) {
    ChiSquareCount count;
    for (int i = 0; i < 20'000; ++i) {
      double chi2 = 0.0;
      for (int k = 0; k < dof; ++k) {
        const double z = stream.normal();
        chi2 += z * z;
      }
      count.add(chi2, dof);
    }
    EXPECT_EQ(count.samples, 20'000);
    EXPECT_NEAR(count.sum_per_dof / count.samples, 1.0, 4 * std::sqrt(2.0 / dof / 20'000)) << dof;
    EXPECT_NEAR(static_cast<double>(count.inside) / count.samples, 0.95,
                4 * std::sqrt(0.95 * 0.05 / 20'000))
        << dof;
  }
}

TEST(ChiSquareCount, WhatHasNoDegreeOfFreedomIsNotCounted) {
  ChiSquareCount count;
  count.add(1.0, 0);
  count.add(1.0, 4);
  EXPECT_EQ(count.samples, 0);
}

}  // namespace
}  // namespace gatefly::closed_loop
