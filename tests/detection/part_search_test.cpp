// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/part_search.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;

std::optional<GatePart> part_in(const Canvas& canvas) {
  const auto bytes = canvas.yuv444();
  return PartSearch{}.detect({bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()},
                             ColorModel::described({1.0, 0.4, 0.0}));
}

// How far a point is from the middle line of the left (-1) or right bar (+1) [px].
double off_bar(const Vector2d& px, double side, const View& view, const CameraRig& rig) {
  double nearest = 1e9;
  for (double z = -0.5; z <= 0.5; z += 0.005)
    if (const auto on_bar = pixel_of({0, side * 0.475, z}, view, rig))
      nearest = std::min(nearest, (*on_bar - px).norm());
  return nearest;
}

bool well_inside(const Vector2d& p) { return p.x() > 5 && p.x() < 309 && p.y() > 5 && p.y() < 154; }
bool well_outside(const Vector2d& p) {
  return p.x() < -5 || p.x() > 319 || p.y() < -5 || p.y() > 164;
}

class BarsAtPitch : public ::testing::TestWithParam<double> {};

// A tilted camera draws upright bars slanted: 25° down (pitch -5°) spreads one over 25 columns.
TEST_P(BarsAtPitch, BothBarsOfAGateTooNearToBeSeenWholeAreFound) {
  const CameraRig rig = bebop_rig();
  int found = 0;
  constexpr int kViews = 25;
  for_all(kViews, [&](Rng& rng) {
    const View view{{rng.uniform(-1.3, -0.6), rng.uniform(-0.15, 0.15), rng.uniform(-0.1, 0.1)},
                    {rng.uniform(-0.04, 0.04), GetParam() * kDegree, rng.uniform(-0.08, 0.08)}};
    Canvas canvas{315, 160};
    canvas.add_noise(rng);
    canvas.draw_gate(view, rig);
    const auto part = part_in(canvas);
    if (!part) return;
    ++found;
    EXPECT_LT(off_bar(part->bars.left_px, -1.0, view, rig), 1.5) << "left";
    EXPECT_LT(off_bar(part->bars.right_px, +1.0, view, rig), 1.5) << "right";
    EXPECT_LT(part->bars.left_px.x(), part->bars.right_px.x());
    EXPECT_EQ(part->gate.method, DetectionMethod::kBars);
  });
  EXPECT_GE(found, kViews * 9 / 10);
}
INSTANTIATE_TEST_SUITE_P(Pitch, BarsAtPitch, ::testing::Values(0.0, -5.0, -10.0));

// 60 views, near enough that part of the gate is out of the picture: rolled, too high, too low,
// beside the axis.
TEST(PartSearch, SaysOfEachCornerWhetherItIsInViewAndWhere) {
  const CameraRig rig = bebop_rig();
  int views = 0, found = 0, inside = 0, outside = 0;
  std::vector<double> errors;
  for_all(60, [&](Rng& rng) {
    const View view{{rng.uniform(-1.9, -0.8), rng.uniform(-0.25, 0.25), rng.uniform(-0.4, 0.4)},
                    {rng.uniform(-0.3, 0.3), rng.uniform(-0.15, 0.1), rng.uniform(-0.15, 0.15)}};
    const auto corners = corners_of(1.0, view, rig);
    if (!corners) return;
    // Side bars in view, and every corner clearly in the picture or clearly not.
    int in = 0, out = 0;
    for (const auto& c : *corners) in += well_inside(c), out += well_outside(c);
    const bool sides_in = std::min((*corners)[0].x(), (*corners)[3].x()) > 5 &&
                          std::max((*corners)[1].x(), (*corners)[2].x()) < 309;
    if (in + out < 4 || out == 0 || !sides_in) return;
    ++views;
    Canvas canvas{315, 160};
    canvas.add_noise(rng);
    canvas.draw_gate(view, rig);
    const auto part = part_in(canvas);
    if (!part) return;
    ++found;
    for (std::size_t i = 0; i < 4; ++i) {
      const bool seen = part->gate.corner_fitness[i] > 0.0;
      if (well_inside((*corners)[i])) {
        inside += seen;
        if (seen) errors.push_back((part->gate.corners_px[i] - (*corners)[i]).norm());
      } else {
        outside += seen;
      }
    }
  });
  ASSERT_GT(views, 20);
  EXPECT_GE(found, views * 9 / 10) << "of " << views;
  EXPECT_EQ(outside, 0) << "corners that are not in the picture";
  ASSERT_GT(inside, 20);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 1.5) << "median";
  EXPECT_LT(errors[errors.size() * 9 / 10], 4.0) << "nine of ten";
}

TEST(PartSearch, LowerCornersAreThereExactlyWhenBothAreInView) {
  const CameraRig rig = bebop_rig();
  Canvas open{315, 160}, bars{315, 160};
  open.draw_gate({{-1.5, 0, 0}, {0, -0.1, 0}}, rig);
  bars.draw_gate({{-0.6, 0, 0}, {}}, rig);
  const auto above = part_in(open), all_around = part_in(bars);
  ASSERT_TRUE(above && all_around);
  ASSERT_TRUE(above->lower_corners());
  EXPECT_LT((above->lower_corners()->bottom_left_px - above->gate.corners_px[3]).norm(), 1e-9);
  EXPECT_FALSE(all_around->lower_corners());
}

TEST(PartSearch, AWholeGateIsNoPartOfOne) {
  const CameraRig rig = bebop_rig();
  for (const double distance : {2.2, 3.0, 4.5}) {
    Canvas canvas(315, 160);
    canvas.draw_gate({{-distance, 0.1, -0.4}, {0, 0.1, 0}}, rig);
    EXPECT_FALSE(part_in(canvas)) << distance << " m";
  }
}

TEST(PartSearch, RefusesWhatIsNoPairOfBars) {
  Rng rng{1};
  Canvas nothing{315, 160};
  nothing.add_noise(rng, 60, 25);
  EXPECT_FALSE(part_in(nothing));

  // One bar only: the right half is blanked.
  Canvas one{315, 160};
  one.draw_gate({{-1.2, 0, 0}, {0, 0, 0}}, bebop_rig());
  EXPECT_TRUE(part_in(one));
  one.blank(170, 315);
  EXPECT_FALSE(part_in(one));

  // Two posts that end in the picture without a bar between them.
  Canvas posts{315, 160};
  posts.draw_gate({{-1.5, 0, 0}, {0, -0.1, 0}}, bebop_rig());
  ASSERT_TRUE(part_in(posts));
  posts.blank(0, 315, 70, 160);
  EXPECT_FALSE(part_in(posts));
}

TEST(PartSearch, WhereEverythingIsColouredThereIsNoGate) {
  EXPECT_FALSE(PartSearch{}.detect(Image{}, ColorModel{}));
  for (const auto& [w, h] : {std::pair{1, 1}, std::pair{1, 100}, std::pair{100, 1}, std::pair{3, 2},
                             std::pair{4000, 3}, std::pair{315, 160}}) {
    Canvas canvas{w, h};
    canvas.fill({120, 90, 190});
    EXPECT_FALSE(part_in(canvas)) << w << " x " << h;
  }
}

// Boards of 0.6 m on a gate of 2.7 m, a camera of 90 degrees that looks 20 degrees up: from 5 m on only
// the upper corners are in view.
class BoardsThrough : public ::testing::TestWithParam<AnyCamera> {};

TEST_P(BoardsThrough, TheUpperCornersOfANearGateOfBoardsAreFound) {
  GateDetectorParams params;
  params.bar_ratio = 0.6 / 2.7, params.corner_scale = 2.7 / 2.1;
  params.lens = {.model = GetParam(), .width = 640, .height = 360};
  const CameraRig rig{GetParam(), camera_mount(-20 * kDegree), Eigen::Vector3d::Zero()};
  int views = 0, found = 0;
  for_all(30, [&](Rng& rng) {
    const View view{{rng.uniform(-5.0, -1.8), rng.uniform(-0.3, 0.3), rng.uniform(-0.2, 0.2)},
                    {rng.uniform(-0.1, 0.1), rng.uniform(-0.12, 0.0), rng.uniform(-0.1, 0.1)}};
    const auto truth = corners_of(2.7, view, rig);
    const auto in_view = [](const Vector2d& p, double margin) {
      return p.x() > margin && p.x() < 639 - margin && p.y() > margin && p.y() < 359 - margin;
    };
    if (!truth || !in_view((*truth)[0], 10) || !in_view((*truth)[1], 10) ||
        in_view((*truth)[2], -10) || in_view((*truth)[3], -10))
      return;
    ++views;
    Canvas canvas{640, 360};
    canvas.add_noise(rng, 10.0, 3.0);
    canvas.draw_gate(view, rig, 2.7, 0.6);
    const auto bytes = canvas.yuv444();
    const auto part = PartSearch{params}.detect({bytes.data(), PixelFormat::kYuv444, 640, 360},
                                                ColorModel::described({1.0, 0.4, 0.0}));
    if (!part) return;
    ++found;
    for (const std::size_t k : {0u, 1u}) {
      EXPECT_GT(part->gate.corner_fitness[k], 0.5);
      EXPECT_LT((part->gate.corners_px[k] - (*truth)[k]).norm(), 3.0) << "corner " << k;
    }
  });
  EXPECT_GT(views, 10);
  EXPECT_GE(found, views * 8 / 10);
}

AnyCamera straight() {
  return AnyCamera{Pinhole{.focal_px = {320, 320}, .center_px = {319.5, 179.5}}};
}
// Bends a side that is 300 px long and 150 px from the centre by several pixels.
AnyCamera barrel() {
  return AnyCamera{
      KannalaBrandt{.focal_px = {320, 320}, .center_px = {319.5, 179.5}, .radial = {}}};
}
INSTANTIATE_TEST_SUITE_P(Lens, BoardsThrough, ::testing::Values(straight(), barrel()));

// Beside a board, lower than its top and as wide: what stands there has an outer edge, too, which meets the
// gate's upper edge where there is nothing.
TEST(PartSearch, APanelOfItsColourBesideAGateOfBoardsIsNoCornerOfIt) {
  GateDetectorParams params;
  params.bar_ratio = 0.6 / 2.7, params.corner_scale = 2.7 / 2.1;
  const CameraRig rig{straight(), camera_mount(-20 * kDegree), Eigen::Vector3d::Zero()};
  for (const double x : {-4.6, -4.2, -3.8, -3.4})
    for (const double wide : {0.6, 0.9, 1.2}) {
      const View view{{x, 0.0, 0.0}, {0, 0, 0}};
      const auto truth = corners_of(2.7, view, rig);
      ASSERT_TRUE(truth);
      const double board = 0.6 / 2.7 * ((*truth)[1].x() - (*truth)[0].x());
      Canvas canvas{640, 360};
      Rng rng{1};
      canvas.add_noise(rng, 10.0, 3.0);
      canvas.draw_gate(view, rig, 2.7, 0.6);
      const auto px = [](double value) { return static_cast<int>(value); };
      canvas.paint(px((*truth)[0].x() - wide * board), px((*truth)[0].x() + 2),
                   px((*truth)[0].y() + 1.2 * board), 360, {120, 90, 190});
      const auto bytes = canvas.yuv444();
      const auto part = PartSearch{params}.detect({bytes.data(), PixelFormat::kYuv444, 640, 360},
                                                  ColorModel::described({1.0, 0.4, 0.0}));
      if (!part) continue;
      for (const std::size_t k : {0u, 1u})
        EXPECT_TRUE(part->gate.corner_fitness[k] == 0.0 ||
                    (part->gate.corners_px[k] - (*truth)[k]).norm() < 5.0)
            << k << " at " << x << ", " << wide;
    }
}

// Two orange posts are the sides of a thin gate too near to be whole, never those of boards.
TEST(PartSearch, TwoPostsAreNoGateOfBoards) {
  GateDetectorParams params;
  params.bar_ratio = 0.6 / 2.7, params.corner_scale = 2.7 / 2.1;
  Canvas canvas{640, 360};
  for (const int u : {150, 420}) canvas.paint(u, u + 70, 0, 360, {120, 90, 190});
  const auto bytes = canvas.yuv444();
  EXPECT_FALSE(PartSearch{params}
                   .detect({bytes.data(), PixelFormat::kYuv444, 640, 360},
                           ColorModel::described({1.0, 0.4, 0.0}))
                   .has_value());
}

}  // namespace
}  // namespace gatefly
