// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/corner_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/rng.hpp"

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/worst_corner.hpp"

namespace gatefly {
namespace {

using namespace test;

constexpr double kCornerBar = 0.05 / 0.95;  // of a side of the middle lines

/// A camera without bend, so that the middle lines of the bars are straight.
CameraRig straight_rig() {
  return {AnyCamera{Pinhole{.center_px = {157, 80}}}, camera_mount(0.0), Eigen::Vector3d::Zero()};
}

Quad shaken(Quad quad, Rng& rng, double px) {
  for (auto& p : quad) p += Eigen::Vector2d{rng.uniform(-px, px), rng.uniform(-px, px)};
  return quad;
}

/// A gate of 1 m with bars of 5 cm in a picture, and where its bars' middle lines cross.
struct CornerScene {
  CornerScene(const View& view, Rng& rng, double noise)
      : truth{corners_of(0.95, view, straight_rig()).value()} {
    Canvas canvas(315, 160);
    canvas.draw_gate(view, straight_rig());
    if (noise > 0.0) canvas.add_noise(rng, noise, noise);
    bytes = canvas.yuv444();
  }
  [[nodiscard]] Quad refined(const Quad& rough,
                             RefinementEffort effort = RefinementEffort::kCareful) const {
    return refined_corners({bytes.data(), PixelFormat::kYuv444, 315, 160}, rough, kCornerBar,
                           effort);
  }

  Quad truth;
  std::vector<std::uint8_t> bytes;
};

View any_view(Rng& rng) {
  return {{-rng.uniform(2.2, 5.5), rng.uniform(-0.4, 0.4), rng.uniform(-0.1, 0.1)},
          {.roll = rng.uniform(-1.0, 1.0)}};
}

TEST(RefinedCorners, AreExactOnACleanPictureAtAnyTurn) {
  for_all(40, [](Rng& rng) {
    const CornerScene scene{any_view(rng), rng, 0.0};
    EXPECT_LT(worst_corner(scene.refined(shaken(scene.truth, rng, 1.5)), scene.truth), 0.25);
  });
}

// Chroma and luma off by up to 6 levels at every pixel, the frame given to 1.5 px.
TEST(RefinedCorners, NoiseMovesThemByAFractionOfAPixel) {
  std::vector<double> errors;
  for_all(60, [&](Rng& rng) {
    const CornerScene scene{any_view(rng), rng, 6.0};
    errors.push_back(worst_corner(scene.refined(shaken(scene.truth, rng, 1.5)), scene.truth));
  });
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.25);
  EXPECT_LT(errors.back(), 0.6);
}

TEST(RefinedCorners, HardlyDependOnWhereTheyStart) {
  for_all(20, [](Rng& rng) {
    const CornerScene scene{any_view(rng), rng, 6.0};
    const Quad a = scene.refined(shaken(scene.truth, rng, 1.5)),
               b = scene.refined(shaken(scene.truth, rng, 1.5));
    EXPECT_LT(worst_corner(a, b), 0.25);
  });
}

TEST(RefinedCorners, TheQuickWayComesNearTheCarefulOne) {
  for_all(40, [](Rng& rng) {
    const CornerScene scene{any_view(rng), rng, 6.0};
    const Quad rough = shaken(scene.truth, rng, 1.5);
    EXPECT_LT(worst_corner(scene.refined(rough, RefinementEffort::kQuick), scene.refined(rough)),
              0.5);
  });
}

// A cable tray behind half of a washed-out bar, as bright beside it as the bar is colourful: at
// most a pixel (1.7 when luma counted in full and pixels by where they were read).
TEST(RefinedCorners, BearABrightStripeBehindABar) {
  const View view{{-3, 0, 0}, {}};
  const Quad truth = corners_of(0.95, view, straight_rig()).value();
  for (const int beside : {-6, -5, -4, -3, -2, 2, 3, 4, 5, 6}) {
    Canvas canvas(315, 160);
    const int row = static_cast<int>(std::lround(truth[0].y())) + beside;
    canvas.paint(0, 157, row, row + 2, {150, 128, 128});
    canvas.draw_gate(view, straight_rig(), 1.0, 0.05, {130, 112, 138});
    const auto bytes = canvas.yuv444();
    for (const RefinementEffort effort : {RefinementEffort::kQuick, RefinementEffort::kCareful})
      EXPECT_LT(worst_corner(refined_corners({bytes.data(), PixelFormat::kYuv444, 315, 160}, truth,
                                             kCornerBar, effort),
                             truth),
                1.0)
          << beside;
  }
}

TEST(RefinedCorners, StayWhereThereIsNoBar) {
  const auto bytes = Canvas(315, 160).yuv444();
  const Quad frame = corners_of(0.95, {{-3, 0, 0}, {.roll = 0.2}}, straight_rig()).value();
  EXPECT_LT(worst_corner(
                refined_corners({bytes.data(), PixelFormat::kYuv444, 315, 160}, frame, kCornerBar),
                frame),
            1e-9);
}

// Left half of the gate beyond the border: the sides in view are still drawn onto their bars.
TEST(RefinedCorners, OfAGateThatTheBorderCuts) {
  Rng rng{1};
  const CornerScene scene{{{-2.5, 2.2, 0.0}, {.roll = 0.1}}, rng, 0.0};
  ASSERT_LT(scene.truth[0].x(), -10.0);
  const Quad refined = scene.refined(shaken(scene.truth, rng, 1.0));
  EXPECT_LT((refined[1] - scene.truth[1]).norm(), 0.3);
  EXPECT_LT((refined[2] - scene.truth[2]).norm(), 0.3);
}

// With any frame, nothing is read out of bounds and no number is broken that was not.
TEST(RefinedCorners, BearAnyFrameInAnyPicture) {
  for_all(300, [](Rng& rng) {
    const int width = 1 + static_cast<int>(rng.uniform(0, 40)),
              height = 1 + static_cast<int>(rng.uniform(0, 40));
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(3 * width * height));
    for (auto& b : bytes) b = static_cast<std::uint8_t>(rng.uniform(0, 256));
    Quad frame;
    for (auto& p : frame) p = {rng.uniform(-60, 100), rng.uniform(-60, 100)};
    const Quad refined = refined_corners({bytes.data(), PixelFormat::kYuv444, width, height}, frame,
                                         rng.uniform(0, 2));
    for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(refined[i].allFinite());
  });
  const Quad nowhere{Eigen::Vector2d{1e12, 0}, {-1e12, 5}, {3, 1e12}, {3, 3}};
  const std::vector<std::uint8_t> bytes(3 * 20 * 20, 100);
  (void)refined_corners({bytes.data(), PixelFormat::kYuv444, 20, 20}, nowhere, 1e9);
  (void)refined_corners(Image{}, nowhere, 1.0);
}

}  // namespace
}  // namespace gatefly
