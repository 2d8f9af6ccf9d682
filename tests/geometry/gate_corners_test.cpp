// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/gate_corners.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/for_all.hpp"

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

// Seen along the way through the gate, upright edges are drawn upright and level ones level: of the
// frame's two faces the outermost edges show, of the opening's the innermost.
TEST(OutlineShift, PutsCornersWhereTheOutlineHasThem) {
  constexpr double kNear = 0.13;
  test::for_all(200, [&](Rng& rng) {
    const Eigen::Vector3d eye{rng.uniform(-8.0, -0.5), rng.uniform(-4.0, 4.0),
                              rng.uniform(-4.0, 4.0)};
    for (const CornerOf of : {CornerOf::kFrame, CornerOf::kOpening}) {
      const auto corners = gate_corners_G(of == CornerOf::kFrame ? 2.7 : 1.5);
      for (const Eigen::Vector3d& corner : corners) {
        const Eigen::Vector3d shown =
            corner - Eigen::Vector3d{kNear, 0, 0} + outline_shift_G(corner, eye, kNear, of) - eye;
        for (const Eigen::Index axis : {1, 2}) {
          const double off = corner[axis] - eye[axis], out = corner[axis] > 0.0 ? 1.0 : -1.0;
          const auto [less, more] =
              std::minmax({out * off / (-kNear - eye.x()), out * off / (kNear - eye.x())});
          EXPECT_NEAR(out * shown[axis] / shown.x(), of == CornerOf::kFrame ? more : less, 1e-12);
        }
      }
    }
  });
}

TEST(OutlineShift, IsNoneOfThinBarsAndOfAFrameSeenFromAhead) {
  const auto corner = gate_corners_G(2.7)[0];
  EXPECT_EQ(outline_shift_G(corner, {-3, 5, 1}, 0.0, CornerOf::kFrame), Eigen::Vector3d::Zero());
  EXPECT_EQ(outline_shift_G(corner, {-3, 1, 1}, 0.1, CornerOf::kFrame), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace gatefly
