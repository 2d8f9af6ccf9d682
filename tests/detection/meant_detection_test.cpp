// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/meant_detection.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/worst_corner.hpp"

namespace gatefly {
namespace {

using namespace test;

CameraRig meant_rig() {
  return {AnyCamera{Pinhole{.focal_px = {320, 320}, .center_px = {319.5, 179.5}}},
          camera_mount(0.0), Eigen::Vector3d::Zero()};
}

/// A gate in a picture, and the frame of its bars' middle lines.
struct Scene {
  Scene(const View& view, double side, double bar) {
    Canvas canvas{640, 360};
    canvas.draw_gate(view, meant_rig(), side, bar);
    bytes = canvas.yuv444();
    corners = corners_of(side, view, meant_rig()).value();
    frame.quad = corners_of(side - bar, view, meant_rig()).value();
    frame.score.total = 3.0, frame.score.side.fill(1.0);
  }
  [[nodiscard]] GateDetection meant(const GateDetectorParams& params) const {
    return meant_detection(frame, DetectionMethod::kSnake,
                           {bytes.data(), PixelFormat::kYuv444, 640, 360}, params, {});
  }

  std::vector<std::uint8_t> bytes;
  Quad corners;
  Frame frame;
};

TEST(MeantDetection, OfThinBarsIsTheirMiddleLinesMadeLarger) {
  const Scene scene{{{-3, 0.2, 0.1}, {}}, 1.0, 0.05};
  const GateDetection outer = scene.meant({});
  EXPECT_LT(worst_corner(outer.corners_px, scene.corners), 0.01);
  EXPECT_EQ(outer.method, DetectionMethod::kSnake);
  EXPECT_TRUE(outer.whole);
  GateDetectorParams middles;
  middles.corner_scale = 1.0;
  EXPECT_LT(worst_corner(scene.meant(middles).corners_px, scene.frame.quad), 1e-9);
}

TEST(MeantDetection, OfThinBarsAsksNoPixel) {
  Scene scene{{{-3, 0.2, 0.1}, {}}, 1.0, 0.05};
  const Quad with = scene.meant({}).corners_px;
  scene.bytes.assign(scene.bytes.size(), 128);
  EXPECT_EQ(scene.meant({}).corners_px, with);
}

GateDetectorParams boards(double meant_m) {
  GateDetectorParams params;
  params.bar_ratio = 0.6 / 2.7, params.corner_scale = meant_m / 2.1;
  return params;
}

// Middle lines 4 px off: the edges are found where they are.
TEST(MeantDetection, OfBoardsIsTheirOuterEdges) {
  Scene scene{{{-6, 0.2, 0.1}, {0.1, 0, 0}}, 2.7, 0.6};
  for (auto& p : scene.frame.quad) p += Eigen::Vector2d{4.0, -3.0};
  const GateDetection gate = scene.meant(boards(2.7));
  EXPECT_LT(worst_corner(gate.corners_px, scene.corners), 0.3);
  EXPECT_TRUE(gate.whole);
}

TEST(MeantDetection, OfBoardsCanMeanTheOpening) {
  const View view{{-6, 0.0, 0.0}, {}};
  const Scene scene{view, 2.7, 0.6};
  EXPECT_LT(
      worst_corner(scene.meant(boards(1.5)).corners_px, corners_of(1.5, view, meant_rig()).value()),
      0.3);
}

// The lower board is below the picture: its corners are rough, and said to be.
TEST(MeantDetection, OfBoardsSaysWhichCornersNobodySaw) {
  const Scene scene{{{-3.2, 0.0, -1.2}, {}}, 2.7, 0.6};
  ASSERT_GT(scene.corners[2].y(), 365.0);
  ASSERT_GT(scene.corners[0].y(), 5.0);
  const GateDetection gate = scene.meant(boards(2.7));
  EXPECT_FALSE(gate.whole);
  for (const std::size_t k : {0u, 1u}) {
    EXPECT_GT(gate.corner_fitness[k], 0.5) << k;
    EXPECT_LT((gate.corners_px[k] - scene.corners[k]).norm(), 0.5) << k;
  }
  for (const std::size_t k : {2u, 3u}) EXPECT_EQ(gate.corner_fitness[k], 0.0) << k;
}

TEST(MeantDetection, ACornerOutOfViewHasNoFitness) {
  const Scene scene{{{-2, 2.3, 0.0}, {}}, 1.0, 0.05};
  ASSERT_LT(scene.corners[0].x(), 0.0);
  ASSERT_GT(scene.corners[1].x(), 5.0);
  const GateDetection gate = scene.meant({});
  EXPECT_FALSE(gate.whole);
  EXPECT_EQ(gate.corner_fitness[0], 0.0);
  EXPECT_EQ(gate.corner_fitness[3], 0.0);
  EXPECT_DOUBLE_EQ(gate.corner_fitness[1], corner_confidence_of(1.0));
}

}  // namespace
}  // namespace gatefly
