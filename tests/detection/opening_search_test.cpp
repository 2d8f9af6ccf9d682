// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/opening_search.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/worst_corner.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;

constexpr double kWideSide = 2.7, kWideBar = 0.6, kOpening = kWideSide - 2.0 * kWideBar;
constexpr int kWidePicture = 640, kWideHeight = 360;
constexpr std::array<double, 3> kWideOrange{120, 90, 190};

// A pinhole camera of 74 degrees, 20 degrees up.
CameraRig looking_up() {
  return {AnyCamera{Pinhole{.focal_px = {425, 425}, .center_px = {319.5, 179.5}}},
          camera_mount(-20 * kDegree), Eigen::Vector3d::Zero()};
}

Openings openings_in(const Canvas& canvas, double bar_ratio = kWideBar / kWideSide) {
  GateDetectorParams params;
  params.bar_ratio = bar_ratio;
  const auto bytes = canvas.yuv444();
  const auto search = std::make_unique<OpeningSearch>(params);  // its grid is no thing for a stack
  return search->detect({bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()},
                        ColorModel::described({1.0, 0.4, 0.0}));
}

Canvas drawn(const View& view) {
  Canvas canvas{kWidePicture, kWideHeight};
  canvas.draw_gate(view, looking_up(), kWideSide, kWideBar, kWideOrange);
  return canvas;
}

// From where the outer corners are out of the picture, rolled and from aside.
View near_view(Rng& rng) {
  return {{rng.uniform(-4.5, -2.2), rng.uniform(-0.8, 0.8), rng.uniform(0.0, 0.8)},
          {rng.uniform(-0.3, 0.3), rng.uniform(-0.3, -0.1), rng.uniform(-0.3, 0.3)}};
}

TEST(OpeningSearch, FindsTheOpeningOfAGateThatThePictureCannotHold) {
  int whole = 0, cut_outside = 0, missed = 0;
  for_all(60, [&](Rng& rng) {
    const View view = near_view(rng);
    const auto truth = corners_of(kOpening, view, looking_up()),
               outer = corners_of(kWideSide, view, looking_up());
    if (!truth || !inside_picture(*truth, kWidePicture, kWideHeight, 8.0)) return;
    ++whole, cut_outside += !outer || !inside_picture(*outer, kWidePicture, kWideHeight);
    Canvas canvas = drawn(view);
    canvas.add_noise(rng, 10.0, 4.0);
    const Openings found = openings_in(canvas);
    if (found.empty()) ++missed;
    if (found.empty()) return;
    EXPECT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].method, DetectionMethod::kOpening);
    for (const double fitness : found[0].corner_fitness) EXPECT_GT(fitness, 0.5);
    EXPECT_LT(worst_corner(found[0].corners_px, *truth), 1.6) << "what the filter counts with";
  });
  EXPECT_GT(whole, 15);
  EXPECT_LE(missed, whole / 6);
  EXPECT_GT(cut_outside, whole / 2) << "of no use where the gate is whole";
}

TEST(OpeningSearch, HoldsOnBlotchedPaint) {
  int views = 0, good = 0;
  for_all(40, [&](Rng& rng) {
    const View view = near_view(rng);
    const auto truth = corners_of(kOpening, view, looking_up());
    if (!truth || !inside_picture(*truth, kWidePicture, kWideHeight, 8.0)) return;
    ++views;
    Canvas canvas = drawn(view);
    for (int k = 0; k < 150; ++k) {  // paint that is gone in places
      const int u = static_cast<int>(rng.uniform(0, kWidePicture)),
                v = static_cast<int>(rng.uniform(0, kWideHeight));
      canvas.blank(u, u + 6, v, v + 6);
    }
    const Openings found = openings_in(canvas);
    good += !found.empty() && worst_corner(found[0].corners_px, *truth) < 1.5;
  });
  EXPECT_GT(views, 10);
  EXPECT_GE(good, views * 8 / 10);
}

// From 30 to 45 degrees aside a near board is half as wide again as a far one; on the way up to the upper
// one of two gates that stand one on the other nothing else of them is whole.
TEST(OpeningSearch, FromAsideBoardsAreNotAlikeWide) {
  int views = 0, found_it = 0;
  for_all(60, [&](Rng& rng) {
    const double aside = rng.uniform(30, 45) * kDegree * (rng.uniform(-1, 1) < 0 ? -1.0 : 1.0),
                 away = rng.uniform(3.2, 5.0);
    const Eigen::Vector3d upper{-away * std::cos(aside), -away * std::sin(aside),
                                rng.uniform(0.8, 2.0)};
    const Attitude attitude{rng.uniform(-0.05, 0.05), rng.uniform(-0.1, 0.0), 0.8 * aside};
    const auto truth = corners_of(kOpening, {upper, attitude}, looking_up());
    if (!truth || !inside_picture(*truth, kWidePicture, kWideHeight, 8.0)) return;
    ++views;
    Canvas canvas = drawn({upper, attitude});
    const Eigen::Vector3d lower = upper - Eigen::Vector3d{0, 0, kWideSide};
    canvas.draw_gate({lower, attitude}, looking_up(), kWideSide, kWideBar, kWideOrange);
    canvas.add_noise(rng, 10.0, 4.0);
    for (const GateDetection& opening : openings_in(canvas))
      found_it += worst_corner(opening.corners_px, *truth) < 1.6;
  });
  EXPECT_GT(views, 20);
  EXPECT_GE(found_it, views * 9 / 10);
}

// So near that the border cuts the opening: its upper corners are left, and nothing is said of the others.
TEST(OpeningSearch, TellsTheCornersThatTheBorderLeaves) {
  const View view{{-1.5, 0.1, 0.0}, {0.02, 0.0, 0.0}};
  const Quad truth = corners_of(kOpening, view, looking_up()).value();
  ASSERT_GT(truth[2].y(), kWideHeight);
  ASSERT_GT(truth[0].y(), 0.0);
  const Openings found = openings_in(drawn(view));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_GT(std::min(found[0].corner_fitness[0], found[0].corner_fitness[1]), 0.5);
  EXPECT_EQ(std::max(found[0].corner_fitness[2], found[0].corner_fitness[3]), 0.0);
  const double across = truth[1].x() - truth[0].x();
  EXPECT_LT((found[0].corners_px[0] - truth[0]).norm(), 0.01 * across);
  EXPECT_LT((found[0].corners_px[1] - truth[1]).norm(), 0.01 * across);
}

TEST(OpeningSearch, OfSeveralGatesEachHasItsOwn) {
  Canvas canvas{kWidePicture, kWideHeight};
  const View far{{-9.0, 3.4, 0.0}, {0.0, -0.3, 0.0}}, near{{-4.5, -0.7, 0.0}, {0.0, -0.3, 0.0}};
  for (const View& view : {far, near})
    canvas.draw_gate(view, looking_up(), kWideSide, kWideBar, kWideOrange);
  const Openings found = openings_in(canvas);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_LT(worst_corner(found[0].corners_px, corners_of(kOpening, near, looking_up()).value()),
            0.6);
  EXPECT_LT(worst_corner(found[1].corners_px, corners_of(kOpening, far, looking_up()).value()),
            0.6);
}

TEST(OpeningSearch, TakesNoHoleForAnOpening) {
  const auto orange = kWideOrange;
  Canvas wall{kWidePicture, kWideHeight};  // a window in a wall of the gate's colour
  wall.fill(orange), wall.blank(200, 320, 100, 220);
  EXPECT_TRUE(openings_in(wall).empty());
  Canvas poster{kWidePicture, kWideHeight};  // framed as thinly as no gate of boards
  poster.paint(190, 330, 90, 230, orange), poster.blank(200, 320, 100, 220);
  EXPECT_TRUE(openings_in(poster).empty());
  Canvas side{kWidePicture, kWideHeight};  // three boards, in the middle of the picture
  side.paint(140, 380, 40, 280, orange), side.blank(200, 320, 100, 280);
  EXPECT_TRUE(openings_in(side).empty());
  Canvas triangle{kWidePicture, kWideHeight};
  triangle.paint(140, 380, 40, 280, orange);
  for (int v = 100; v < 220; ++v)
    triangle.blank(260 - (v - 100) / 2, 260 + (v - 100) / 2, v, v + 1);
  EXPECT_TRUE(openings_in(triangle).empty());
}

// Another gate behind the right board fills a part of the opening: what is left has four corners, and
// a board that is too wide.
TEST(OpeningSearch, DoesNotTakeAGateBehindForABoard) {
  int refused = 0, seen = 0;
  for_all(30, [&](Rng& rng) {
    const View view{{-5.5, rng.uniform(-0.3, 0.3), 0.3}, {0.0, -0.25, rng.uniform(-0.1, 0.1)}};
    const auto truth = corners_of(kOpening, view, looking_up());
    if (!truth || !inside_picture(*truth, kWidePicture, kWideHeight, 8.0)) return;
    Canvas canvas = drawn(view);
    ASSERT_EQ(openings_in(canvas).size(), 1u);
    const double hidden = rng.uniform(0.12, 0.25) * ((*truth)[1].x() - (*truth)[0].x());
    canvas.paint(static_cast<int>((*truth)[1].x() - hidden), static_cast<int>((*truth)[1].x() + 4),
                 static_cast<int>((*truth)[1].y() - 8), static_cast<int>((*truth)[2].y() + 8),
                 kWideOrange);
    ++seen, refused += openings_in(canvas).empty();
  });
  EXPECT_GT(seen, 15);
  EXPECT_GE(refused, seen * 9 / 10);
}

TEST(OpeningSearch, AsksNothingOfGatesWhoseBarsAreNoBoards) {
  Rng rng{1};
  const View view{{-4.0, 0.0, 0.3}, {0.0, -0.2, 0.0}};
  ASSERT_EQ(openings_in(drawn(view)).size(), 1u);
  EXPECT_TRUE(openings_in(drawn(view), 0.05).empty());
}

// Noise of both colours, pictures of every small size, none at all: an answer within the picture.
TEST(OpeningSearch, SurvivesNonsense) {
  for_all(60, [](Rng& rng) {
    const int width = 1 + static_cast<int>(rng.uniform(0, 90)),
              height = 1 + static_cast<int>(rng.uniform(0, 70)),
              grain = 1 + static_cast<int>(rng.uniform(0, 12));
    Canvas canvas{width, height};
    for (int v = 0; v < height; v += grain)
      for (int u = 0; u < width; u += grain)
        if (rng.uniform(0, 1) < 0.5) canvas.paint(u, u + grain, v, v + grain, kWideOrange);
    for (const GateDetection& opening : openings_in(canvas))
      for (std::size_t i = 0; i < 4; ++i)
        if (opening.corner_fitness[i] > 0.0) {
          EXPECT_TRUE(opening.corners_px[i].allFinite());
        }
  });
  GateDetectorParams params;
  params.bar_ratio = kWideBar / kWideSide;
  EXPECT_TRUE(std::make_unique<OpeningSearch>(params)
                  ->detect({}, ColorModel::described({1.0, 0.4, 0.0}))
                  .empty());
}

}  // namespace
}  // namespace gatefly
