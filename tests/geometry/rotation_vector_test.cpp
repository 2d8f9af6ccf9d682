// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/rotation_vector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;
using test::for_all;
using test::IsNear;

TEST(RotationVector, TurnsAboutItsOwnDirection) {
  EXPECT_THAT(rotation_of({0, 0, 0.7}), IsNear(rotation_z(0.7), 1e-14));
  EXPECT_THAT(rotation_of({-0.02, 0, 0}), IsNear(rotation_x(-0.02), 1e-14));
  EXPECT_THAT(rotation_of({0, kPi, 0}), IsNear(rotation_y(kPi), 1e-14));
}

TEST(RotationVector, IsARotationAndFoundAgainAtEverySize) {
  for_all(200, [](Rng& rng) {
    const double size = rng.uniform(0.0, 1.0) < 0.5 ? 0.2 : 3.0;  // both sides of the series' limit
    const Vector3d turn = rng.uniform(0.0, size) * test::any_direction(rng);
    const Eigen::Matrix3d R = rotation_of(turn);
    EXPECT_THAT(R, test::IsRotation());
    EXPECT_THAT(turn_of(R), IsNear(turn, 1e-9));
  });
}

}  // namespace
}  // namespace gatefly
