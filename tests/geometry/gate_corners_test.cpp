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

TEST(NearFace, IsHalfTheDepthOfBoardsAndNothingOfThinBars) {
  EXPECT_DOUBLE_EQ(near_face(2.7, 0.6, 0.26), 0.13);
  EXPECT_DOUBLE_EQ(near_face(1.0, 0.05, 0.05), 0.0);
  EXPECT_DOUBLE_EQ(near_face(1.0, 0.15, 0.15), 0.0) << "Washington's bars";
}

TEST(NearFace, NobodySaysHowDeepBarsAreSoTheyAreSquareAndBoardsThinner) {
  EXPECT_DOUBLE_EQ(usual_depth(0.05), 0.05);
  EXPECT_DOUBLE_EQ(usual_depth(0.6), 0.10);
}

}  // namespace
}  // namespace gatefly
