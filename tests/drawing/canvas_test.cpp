// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/canvas.hpp"

#include <array>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::drawing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr Color kBlack{0, 0, 0}, kWhite{1, 1, 1};

std::array<int, 3> pixel(const Canvas& canvas, int x, int y) {
  const auto rgb = canvas.rgb();
  const auto at = static_cast<std::size_t>(3 * (y * canvas.width() + x));
  return {rgb.at(at), rgb.at(at + 1), rgb.at(at + 2)};
}

TEST(Canvas, StartsInItsBackgroundAndInRgbOrder) {
  const Canvas canvas(5, 3, color_of(0x102030));
  EXPECT_EQ(canvas.rgb().size(), 3u * 5u * 3u);
  EXPECT_THAT(pixel(canvas, 4, 2), ElementsAre(0x10, 0x20, 0x30));
}

TEST(Canvas, ALineChangesThePixelsUnderItAndNoOthers) {
  Canvas canvas(20, 10, kBlack);
  canvas.line({5, 4.5}, {15, 4.5}, {.color = kWhite, .width = 1.0});
  for (int x = 5; x < 15; ++x) EXPECT_THAT(pixel(canvas, x, 4), ElementsAre(255, 255, 255)) << x;
  for (int x = 0; x < 20; ++x)
    for (const int y : {0, 3, 5, 9})
      EXPECT_THAT(pixel(canvas, x, y), ElementsAre(0, 0, 0)) << x << " " << y;
  EXPECT_THAT(pixel(canvas, 2, 4), ElementsAre(0, 0, 0));
  EXPECT_THAT(pixel(canvas, 17, 4), ElementsAre(0, 0, 0));
}

TEST(Canvas, ADashedLineHasGapsAndTheNextOneHasNot) {
  Canvas canvas(40, 10, kBlack);
  const auto lit = [&](int y) {
    int count = 0;
    for (int x = 0; x < 40; ++x) count += pixel(canvas, x, y)[0] > 250;
    return count;
  };
  canvas.line({0, 2.5}, {40, 2.5}, {.color = kWhite, .width = 1.0, .dash = 4.0});
  canvas.line({0, 6.5}, {40, 6.5}, {.color = kWhite, .width = 1.0});
  EXPECT_LT(lit(2), 30);
  EXPECT_EQ(lit(6), 40);
}

TEST(Canvas, AnOutlineIsClosedAndAPolygonIsFull) {
  const std::array<Eigen::Vector2d, 4> square{{{4.5, 4.5}, {14.5, 4.5}, {14.5, 14.5}, {4.5, 14.5}}};
  Canvas open(20, 20, kBlack), closed(20, 20, kBlack), full(20, 20, kBlack);
  open.polyline(square, {.color = kWhite, .width = 1.0});
  closed.outline(square, {.color = kWhite, .width = 1.0});
  full.polygon(square, kWhite);
  EXPECT_EQ(pixel(open, 4, 9)[0], 0);
  EXPECT_EQ(pixel(closed, 4, 9)[0], 255);
  EXPECT_EQ(pixel(closed, 9, 9)[0], 0);
  EXPECT_EQ(pixel(full, 9, 9)[0], 255);
}

TEST(Canvas, APictureKeepsOrientationAndColours) {
  // Stored 2 x 3, to be turned by 90 degrees: the stored right edge becomes the top.
  const std::array<std::uint8_t, 18> bytes{255, 0,   0,   0,  255, 0,  0,   0, 255,
                                           255, 255, 255, 30, 30,  30, 255, 0, 255};
  const Image image(bytes.data(), PixelFormat::kRgb, 2, 3, 90);
  Canvas canvas(30, 20, kBlack);
  canvas.image(image, {6, 4}, 4.0);
  const auto expect_block = [&](int u, int v, int r, int g, int b) {
    for (const int x : {6 + 4 * u, 6 + 4 * u + 3})
      for (const int y : {4 + 4 * v, 4 + 4 * v + 3}) {
        const auto seen = pixel(canvas, x, y);
        EXPECT_NEAR(seen[0], r, 2) << u << " " << v;
        EXPECT_NEAR(seen[1], g, 2) << u << " " << v;
        EXPECT_NEAR(seen[2], b, 2) << u << " " << v;
      }
  };
  expect_block(0, 0, 0, 255, 0);
  expect_block(1, 0, 255, 255, 255);
  expect_block(2, 0, 255, 0, 255);
  expect_block(0, 1, 255, 0, 0);
  expect_block(1, 1, 0, 0, 255);
  expect_block(2, 1, 30, 30, 30);
  EXPECT_THAT(pixel(canvas, 5, 4), ElementsAre(0, 0, 0));
  EXPECT_THAT(pixel(canvas, 18, 4), ElementsAre(0, 0, 0));
  EXPECT_THAT(pixel(canvas, 6, 12), ElementsAre(0, 0, 0));
}

TEST(Canvas, AnEmptyPictureDrawsNothing) {
  Canvas canvas(4, 4, kBlack);
  canvas.image(Image{}, {0, 0}, 2.0);
  EXPECT_THAT(pixel(canvas, 1, 1), ElementsAre(0, 0, 0));
}

TEST(Canvas, ClippedDrawingStaysInside) {
  Canvas canvas(10, 10, kBlack);
  canvas.clip({.x = 2, .y = 2, .width = 3, .height = 3});
  canvas.fill({.x = 0, .y = 0, .width = 10, .height = 10}, kWhite);
  canvas.unclip();
  EXPECT_EQ(pixel(canvas, 3, 3)[0], 255);
  EXPECT_EQ(pixel(canvas, 6, 3)[0], 0);
  canvas.fill({.x = 6, .y = 3, .width = 1, .height = 1}, kWhite);
  EXPECT_EQ(pixel(canvas, 6, 3)[0], 255);
}

TEST(Canvas, TextIsWhereItsAlignmentSays) {
  const auto lit = [](Align align) {
    Canvas canvas(100, 30, kBlack);
    canvas.text({50, 20}, "gate", {.color = kWhite, .size = 12, .align = align});
    std::array<int, 2> sides{0, 0};
    for (int x = 0; x < 100; ++x)
      for (int y = 0; y < 30; ++y) sides[x < 50 ? 0 : 1] += pixel(canvas, x, y)[0] > 128;
    return sides;
  };
  EXPECT_EQ(lit(Align::kLeft)[0], 0);
  EXPECT_GT(lit(Align::kLeft)[1], 10);
  EXPECT_EQ(lit(Align::kRight)[1], 0);
  EXPECT_GT(lit(Align::kCenter)[0], 10);
  EXPECT_GT(lit(Align::kCenter)[1], 10);
}

TEST(Canvas, ImpossibleSizesAreRefused) {
  EXPECT_THAT(test::error_of([] { Canvas{0, 10}; }), HasSubstr("no picture to draw on"));
  EXPECT_THAT(test::error_of([] { Canvas{-4, 10}; }), HasSubstr("no picture to draw on"));
  EXPECT_THAT(test::error_of([] { Canvas{100'000, 10}; }), HasSubstr("no picture to draw on"));
}

TEST(Canvas, APngThatCannotBeWrittenLeavesNothing) {
  const test::TempFolder folder;
  const Canvas canvas(4, 4);
  EXPECT_THAT(test::error_of([&] { canvas.write_png(folder.path() / "missing" / "a.png"); }),
              HasSubstr("a.png"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  canvas.write_png(folder.path() / "a.png");
  EXPECT_THAT(files::read_file(folder.path() / "a.png"), HasSubstr("PNG"));
}

}  // namespace
}  // namespace gatefly::drawing
