// SPDX-License-Identifier: Apache-2.0
// How far a path is from the truth, but for where and when all of it is.
#include "gatefly/tasks/smoothing/alignment.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"

#include "support/generators.hpp"

namespace gatefly::smoothing {
namespace {

using Eigen::Vector3d;

Vector3d loop(double t) { return {4 * std::cos(0.5 * t), 3 * std::sin(0.5 * t), -1.5}; }

TEST(Alignment, APathThatIsElsewhereTurnedAndEarlyIsAsGoodAsItsShape) {
  Rng rng{3};
  std::vector<Place> path, truth;
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.01 * i;
    const Vector3d noise{test::normal(rng), test::normal(rng), test::normal(rng)};
    path.push_back({t, rotation_z(-0.1) * loop(t) + Vector3d{0.3, -0.2, 0.1}});
    if (i % 5 == 0) truth.push_back({t + 0.04, loop(t) + 0.02 * noise});
  }
  const auto found = aligned(path, truth);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->lag, 0.04, 1e-9);
  EXPECT_NEAR(found->turned, 0.1, 0.005);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found->rms(axis), 0.02, 0.004);
}

TEST(Alignment, AFewPlacesAreNoPath) {
  const std::vector<Place> few(9);
  EXPECT_FALSE(aligned(few, few));
}

}  // namespace
}  // namespace gatefly::smoothing
