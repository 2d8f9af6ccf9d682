// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/bar_finder.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/orange.hpp"

namespace gatefly {
namespace {

using namespace test;

constexpr std::array<double, 3> kPaint{120, 90, 190};
constexpr int kWidest = 5, kAround = 1;

BarFinder::Bars bars_in(const Canvas& canvas, int widest = kWidest) {
  const auto bytes = canvas.yuv444();
  BarFinder finder{widest, kAround};
  return finder.find({bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()},
                     kOrange);
}

/// An upright bar of 6 px whose middle is at x(v) in row v.
template <class X>
void draw_bar(Canvas& canvas, int top, int bottom, const X& x) {
  for (int v = top; v < bottom; ++v) {
    const int first = static_cast<int>(std::lround(x(v) - 2.5));
    canvas.paint(first, first + 6, v, v + 1, kPaint);
  }
}

TEST(BarFinder, ACurveFollowsABentBarWhereItsLineCannot) {
  Canvas canvas{315, 160};
  const auto x = [](double v) { return 100 + 0.004 * (v - 80) * (v - 80); };
  draw_bar(canvas, 0, 160, x);
  const BarFinder::Bars bars = bars_in(canvas);
  ASSERT_EQ(bars.size(), 1u);
  double off_line = 0.0;
  for (double v = 8.0; v < 152.0; v += 4.0) {
    EXPECT_NEAR(bars[0].on_curve(v).x(), x(v), 1.0) << v;
    off_line = std::max(off_line, std::abs(bars[0].x(v) - x(v)));
  }
  EXPECT_GT(off_line, 4.0);
}

// Every second pixel of every eighth row is read: a middle is good to a sample, an end to a row of
// them and the height of a pixel.
TEST(BarFinder, ADrawnBarIsFoundFromEndToEnd) {
  for_all(100, [](Rng& rng) {
    const double slope = rng.uniform(-0.3, 0.3), at_80 = rng.uniform(60.0, 250.0);
    const int top = static_cast<int>(rng.uniform(0.0, 50.0)),
              bottom = static_cast<int>(rng.uniform(110.0, 160.0));
    const auto x = [&](double v) { return at_80 + slope * (v - 80.0); };
    Canvas canvas{315, 160};
    draw_bar(canvas, top, bottom, x);
    const BarFinder::Bars bars = bars_in(canvas);
    ASSERT_EQ(bars.size(), 1u);
    EXPECT_NEAR(bars[0].top, top, 9.0);
    EXPECT_NEAR(bars[0].bottom, bottom - 1, 9.0);
    for (double v = bars[0].top; v <= bars[0].bottom; v += 8.0)
      EXPECT_NEAR(bars[0].x(v), x(v), 2.0) << v;
  });
}

TEST(BarFinder, ALongerBarIsStronger) {
  double before = 0.0;
  for (const int length : {30, 50, 80, 120, 160}) {
    Canvas canvas{315, 160};
    draw_bar(canvas, 0, length, [](double) { return 150.0; });
    const BarFinder::Bars bars = bars_in(canvas);
    ASSERT_EQ(bars.size(), 1u) << length;
    EXPECT_GT(bars[0].strength, before) << length;
    before = bars[0].strength;
  }
}

TEST(BarFinder, OneMissingRowIsNoEndAndTwoAre) {
  // rows are read in the middle of each eight
  for (const auto& [hidden, pieces] : {std::pair{8, 1u}, {16, 2u}}) {
    Canvas canvas{315, 160};
    draw_bar(canvas, 0, 160, [](double) { return 150.0; });
    canvas.blank(0, 315, 80, 80 + hidden);
    EXPECT_EQ(bars_in(canvas).size(), pieces) << hidden;
  }
}

TEST(BarFinder, WhatIsTooWideTooShortOrLevelIsNone) {
  Canvas wide{315, 160}, spot{315, 160}, level{315, 160};
  wide.paint(140, 160, 0, 160, kPaint);
  spot.paint(150, 156, 60, 76, kPaint);
  level.paint(0, 315, 80, 86, kPaint);
  EXPECT_TRUE(bars_in(wide).empty());
  EXPECT_EQ(bars_in(wide, 16).size(), 1u) << "for who looks for wide ones";
  EXPECT_TRUE(bars_in(spot).empty()) << "two rows";
  EXPECT_TRUE(bars_in(level).empty());
}

TEST(BarFinder, NothingIsFoundInAnEmptyOrATinyPicture) {
  BarFinder finder{kWidest, kAround};
  EXPECT_TRUE(finder.find(Image{}, kOrange).empty());
  EXPECT_FALSE(finder.has_evidence());
  for (const auto& [width, height] :
       {std::pair{315, 160}, {7, 100}, {100, 7}, {1, 1}, {2000, 8}, {8, 2000}})
    EXPECT_TRUE(bars_in(Canvas{width, height}).empty()) << width << " x " << height;
}

}  // namespace
}  // namespace gatefly
