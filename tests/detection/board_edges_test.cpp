// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/board_edges.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/worst_corner.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;

constexpr double kSide = 2.7, kBar = 0.6;
constexpr int kBoardWidth = 640, kBoardHeight = 360;
constexpr std::array<double, 3> kBoardOrange{120, 90, 190};

/// A pinhole camera of 90 degrees, 20 degrees up.
CameraRig rig() {
  return {AnyCamera{Pinhole{.focal_px = {320, 320}, .center_px = {319.5, 179.5}}},
          camera_mount(-20 * kDegree), Eigen::Vector3d::Zero()};
}

Image image_of(const std::vector<std::uint8_t>& bytes) {
  return {bytes.data(), PixelFormat::kYuv444, kBoardWidth, kBoardHeight};
}

/// Its boards' middle lines, and their width, as wrong as a first look may be.
Quad rough_middles(const View& view, Rng& rng, double board_px) {
  Quad middles = corners_of(kSide - kBar, view, rig()).value();
  for (Vector2d& p : middles)
    p += board_px * Vector2d{rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2)};
  return middles;
}

double board_px(const Quad& corners) { return kBar / kSide * std::sqrt(std::abs(area(corners))); }

View whole_view(Rng& rng) {
  return {{rng.uniform(-12.0, -7.5), rng.uniform(-1.5, 1.5), rng.uniform(-0.3, 0.3)},
          {rng.uniform(-0.15, 0.15), rng.uniform(-0.3, -0.15), rng.uniform(-0.15, 0.15)}};
}

/// Views of a whole gate, drawn, spoilt and looked at: check(edges, the gate's corners).
template <class Spoil, class Check>
void for_whole_gates(const Spoil& spoil, const Check& check) {
  int views = 0;
  for_all(40, [&](Rng& rng) {
    const View view = whole_view(rng);
    const auto truth = corners_of(kSide, view, rig());
    if (!truth || !inside_picture(*truth, kBoardWidth, kBoardHeight, 25.0)) return;
    ++views;
    Canvas canvas{kBoardWidth, kBoardHeight};
    canvas.draw_gate(view, rig(), kSide, kBar, kBoardOrange);
    spoil(canvas, rng);
    const auto bytes = canvas.yuv444();
    const double px = board_px(*truth);
    check(board_edges(image_of(bytes), rough_middles(view, rng, px), px), *truth);
  });
  EXPECT_GT(views, 20);
}

TEST(BoardEdges, CrossWhereTheGatesCornersAre) {
  for_whole_gates([](Canvas&, Rng&) {},
                  [](const BoardEdges& edges, const Quad& truth) {
                    EXPECT_LT(worst_corner(edges.corners, truth), 0.3);
                    for (std::size_t k = 0; k < 4; ++k) EXPECT_TRUE(edges.has(k));
                  });
}

// Spots of 5 px without paint, a twentieth of the picture: an edge is where the paint ends that is left.
TEST(BoardEdges, HoldOnWornPaintAndNoise) {
  for_whole_gates(
      [](Canvas& canvas, Rng& rng) {
        for (int k = 0; k < 500; ++k) {
          const int u = static_cast<int>(rng.uniform(0, kBoardWidth)),
                    v = static_cast<int>(rng.uniform(0, kBoardHeight));
          canvas.blank(u, u + 5, v, v + 5);
        }
        canvas.add_noise(rng, 10.0, 4.0);
      },
      [](const BoardEdges& edges, const Quad& truth) {
        EXPECT_LT(worst_corner(edges.corners, truth), 1.0);
      });
}

// From 2 m a camera that looks up shows the upper corners only.
TEST(BoardEdges, SayWhichSidesTheBorderLeaves) {
  const View view{{-2.5, 0.1, 0.0}, {0.02, 0.0, 0.0}};
  const Quad truth = corners_of(kSide, view, rig()).value();
  ASSERT_GT(truth[2].y(), kBoardHeight);
  Canvas canvas{kBoardWidth, kBoardHeight};
  canvas.draw_gate(view, rig(), kSide, kBar, kBoardOrange);
  const auto bytes = canvas.yuv444();
  Quad middles = corners_of(kSide - kBar, view, rig()).value();
  // A search knows of the lower corners only where the upright boards leave the picture.
  for (const auto& [lower, upper] : {std::pair{3u, 0u}, std::pair{2u, 1u}}) {
    const Vector2d d = middles[lower] - middles[upper];
    middles[lower] = middles[upper] + (kBoardHeight - 1 - middles[upper].y()) / d.y() * d;
  }
  const BoardEdges edges = board_edges(image_of(bytes), middles, kBar / 2.5 * 320);
  EXPECT_TRUE(edges.has(0) && edges.has(1));
  EXPECT_FALSE(edges.has(2) || edges.has(3));
  EXPECT_LT((edges.corners[0] - truth[0]).norm(), 0.5);
  EXPECT_LT((edges.corners[1] - truth[1]).norm(), 0.5);
}

TEST(BoardEdges, WithoutAnEdgeLieHalfABoardBeyondTheMiddleLine) {
  Canvas canvas{kBoardWidth, kBoardHeight};
  const auto bytes = canvas.yuv444();
  const Quad middles{{{200, 100}, {400, 100}, {400, 300}, {200, 300}}};
  const BoardEdges edges = board_edges(image_of(bytes), middles, 40.0);
  const Quad half{{{180, 80}, {420, 80}, {420, 320}, {180, 320}}};
  EXPECT_LT(worst_corner(edges.corners, half), 1e-6);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_FALSE(edges.has(k));
}

// Corners anywhere, boards of no or any width, no picture at all: an answer, and no reading beyond it.
TEST(BoardEdges, SurviveNonsense) {
  Canvas canvas{64, 48};
  const auto bytes = canvas.yuv444();
  for_all(200, [&](Rng& rng) {
    Quad quad;
    for (Vector2d& p : quad) p = {rng.uniform(-300, 300), rng.uniform(-300, 300)};
    (void)board_edges({bytes.data(), PixelFormat::kYuv444, 64, 48}, quad, rng.uniform(0.0, 500.0));
  });
  Quad zero;
  zero.fill(Vector2d::Zero());
  (void)board_edges({}, zero, 0.0);
  const double nan = std::nan("");
  zero[1] = {nan, 1e300};
  (void)board_edges({bytes.data(), PixelFormat::kYuv444, 64, 48}, zero, nan);
}

}  // namespace
}  // namespace gatefly
