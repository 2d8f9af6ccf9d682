// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/frame_fit.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/rng.hpp"

namespace gatefly {
namespace {

TEST(NearestCell, IsTheFloorOfHalfACellMore) {
  for (int cell = -1000; cell <= 1000; ++cell)
    for (const double off : {-0.5, -0.49, 0.0, 0.25, 0.49})
      ASSERT_EQ(nearest_cell(cell + off), cell) << cell << " + " << off;
  Rng rng{1};
  for (int i = 0; i < 100'000; ++i) {
    const double x = rng.uniform(-16'000.0, 16'000.0);
    ASSERT_EQ(nearest_cell(x), static_cast<int>(std::floor(x + 0.5))) << x;
  }
}

}  // namespace
}  // namespace gatefly
