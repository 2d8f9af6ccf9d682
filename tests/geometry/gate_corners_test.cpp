// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/gate_corners.hpp"

#include <gtest/gtest.h>

namespace gatefly {
namespace {

// G: x through the gate, y right, z down.
TEST(GateCorners, RunClockwiseFromTopLeftForWhoFliesThroughTheGate) {
  const auto corners = gate_corners_G(1.4);
  EXPECT_EQ(corners[0], Eigen::Vector3d(0, -0.7, -0.7)) << "top left";
  EXPECT_EQ(corners[1], Eigen::Vector3d(0, 0.7, -0.7)) << "top right";
  EXPECT_EQ(corners[2], Eigen::Vector3d(0, 0.7, 0.7)) << "bottom right";
  EXPECT_EQ(corners[3], Eigen::Vector3d(0, -0.7, 0.7)) << "bottom left";
}

}  // namespace
}  // namespace gatefly
