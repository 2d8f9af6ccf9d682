// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/plot.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gatefly::drawing {
namespace {

using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Ticks, AreRoundNumbersInsideTheRange) {
  EXPECT_THAT(ticks(0.0, 1.0, 5), ElementsAre(DoubleEq(0.0), DoubleEq(0.2), DoubleEq(0.4),
                                              DoubleEq(0.6), DoubleEq(0.8), DoubleEq(1.0)));
  EXPECT_THAT(ticks(-7.0, 12.0, 4), ElementsAre(-5.0, 0.0, 5.0, 10.0));
  EXPECT_THAT(ticks(1.0, 1.0, 4), IsEmpty());
  EXPECT_THAT(ticks(0.0, std::numeric_limits<double>::infinity(), 4), IsEmpty());
}

TEST(Ticks, ZeroHasNoSign) {
  for (const double tick : ticks(-0.01, 0.5, 5)) EXPECT_FALSE(tick == 0.0 && std::signbit(tick));
}

/// Pixels of one colour.
int count(const Canvas& canvas, const Color& color) {
  const auto rgb = canvas.rgb();
  int pixels = 0;
  for (std::size_t i = 0; i < rgb.size(); i += 3)
    pixels += rgb[i] == std::lround(255 * color.r) && rgb[i + 1] == std::lround(255 * color.g) &&
              rgb[i + 2] == std::lround(255 * color.b);
  return pixels;
}

TEST(Plot, EveryPointLeavesItsMark) {
  constexpr Color kRed = color_of(0xff0000);
  const auto marked = [&](const std::vector<Eigen::Vector2d>& points) {
    return count(draw({.series = {{.name = "", .points = points, .color = kRed, .line = false}}}),
                 kRed);
  };
  const int legend = marked({});
  const int one = marked({{1, 1}, {2, 0.5}}) - legend;
  EXPECT_GT(one, 40);
  EXPECT_GT(marked({{1, 1}, {1.5, 0.7}, {2, 0.5}}) - legend, one);
}

TEST(Plot, WhatCannotBeShownIsLeftOut) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Plot plot{
      .series = {{.name = "some", .points = {{0.0, 1.0}, {-1.0, 1.0}, {kNan, 1.0}, {1.0, kNan}}}},
      .log_x = true};
  const Canvas canvas = draw(plot, 300, 200);
  EXPECT_EQ(canvas.width(), 300);
  EXPECT_EQ(count(canvas, kLight.found),
            count(draw({.series = {{.name = "some"}}, .log_x = true}, 300, 200), kLight.found));
}

TEST(Plot, AnAreaIsFilledAndACurveWithoutMarksIsThinner) {
  constexpr Color kRed = color_of(0xff0000);
  const auto drawn = [&](const PlotSeries& look) {
    PlotSeries series = look;
    series.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, series.color = kRed;
    return count(draw({.series = {series}}), kRed);
  };
  EXPECT_GT(drawn({.area = true}), 100'000) << "most of 860 x 424 px";
  EXPECT_LT(drawn({.marks = false}), drawn({}) - 4 * 20);
  EXPECT_LT(drawn({.marks = false, .dash = 4.0}), drawn({.marks = false}));
}

TEST(Plot, ALegendThatIsTooWideGoesOnInTheNextLine) {
  const std::string name(40, 'n');
  Plot plot;
  for (const Color& color : {color_of(0xff0000), color_of(0x00ff00), color_of(0x0000ff)})
    plot.series.push_back({.name = name, .color = color});
  const Canvas canvas = draw(plot, 500, 400);
  for (const PlotSeries& series : plot.series) EXPECT_GT(count(canvas, series.color), 20);
}

TEST(Plot, MarksAlongALineGoWhenThereAreTooMany) {
  constexpr Color kRed = color_of(0xff0000);
  const auto drawn = [&](int points, bool marks) {
    PlotSeries series{.color = kRed, .marks = marks};
    for (int i = 0; i < points; ++i) series.points.emplace_back(i, 0.5);
    return count(draw({.series = {series}}), kRed);
  };
  EXPECT_GT(drawn(20, true), drawn(20, false));
  EXPECT_EQ(drawn(200, true), drawn(200, false));
}

TEST(Plot, EveryColourHasAMarkOfItsOwn) {
  std::vector<std::vector<bool>> shapes;
  for (const Color& color :
       {kLight.found, kLight.gate_solid, kLight.flown, kLight.estimate, kLight.muted}) {
    const auto rgb =
        draw({.series = {{.points = {{0, 0}, {1, 1}, {2, 2}}, .color = color, .line = false}}})
            .rgb();
    std::vector<bool> shape;
    for (std::size_t i = 0; i < rgb.size(); i += 3)
      shape.push_back(rgb[i] == std::lround(255 * color.r) &&
                      rgb[i + 2] == std::lround(255 * color.b));
    for (const auto& other : shapes) EXPECT_NE(shape, other);
    shapes.push_back(shape);
  }
}

TEST(Plot, ASheetHasPlotsInRowsAndTheLastRowIsFilled) {
  constexpr Color kRed = color_of(0xff0000);
  const std::vector<Plot> plots(
      3,
      Plot{.series = {{.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, .color = kRed, .area = true}}});
  const Canvas sheet = draw_sheet(plots, 2);
  EXPECT_EQ(sheet.width(), kPlotWidth);
  EXPECT_EQ(sheet.height(), 2 * kRowHeight);
  const int small = count(draw(plots[0], kPlotWidth / 2, kRowHeight), kRed),
            wide = count(draw(plots[0], kPlotWidth, kRowHeight), kRed);
  EXPECT_EQ(count(sheet, kRed), 2 * small + wide);
}

TEST(Plot, AQuickRunIsStampedWhereNoTitleIs) {
  const Plot plot{.title = std::string(200, 'T')};
  Canvas stamped = draw(plot, 600, 400);
  stamp_quick(stamped);
  EXPECT_GT(count(stamped, kLight.warn), 100);
  const int ink = count(draw(plot, 600, 400), kLight.ink);
  EXPECT_EQ(count(stamped, kLight.ink), ink) << "the title is covered";
}

}  // namespace
}  // namespace gatefly::drawing
