// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/evidence_map.hpp"

#include <cstdlib>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/orange.hpp"

namespace gatefly {
namespace {

using namespace test;

constexpr std::array<double, 3> kMapPaint{120, 90, 190};

/// A picture that owns its bytes.
struct MapPicture {
  explicit MapPicture(const Canvas& canvas)
      : bytes{canvas.yuv444()},
        image{bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()} {}
  MapPicture(const MapPicture&) = delete;
  MapPicture& operator=(const MapPicture&) = delete;

  std::vector<std::uint8_t> bytes;
  Image image;
};

Canvas any_map_picture(Rng& rng) {
  Canvas canvas{2 + rng.uniform_index(200), 2 + rng.uniform_index(150)};
  canvas.add_noise(rng, 60.0, 60.0);
  return canvas;
}

TEST(EvidenceMap, AlongALineIsTheSameAsCellByCell) {
  for_all(200, [](Rng& rng) {
    const MapPicture picture{any_map_picture(rng)};
    EvidenceMap map;
    map.fill(picture.image, kOrange);
    const auto anywhere = [&rng](int size) {
      return static_cast<std::int64_t>(rng.uniform(-0.3, 1.3) * size * 65536.0);
    };
    const int count = 1 + rng.uniform_index(30);
    const std::int64_t x = anywhere(map.width()), y = anywhere(map.height()),
                       dx = (anywhere(map.width()) - x) / count,
                       dy = (anywhere(map.height()) - y) / count;
    int visited = 0;
    map.along(x, y, dx, dy, count, [&](int k, int evidence) {
      EXPECT_EQ(k, visited++);
      EXPECT_EQ(evidence,
                map.at(static_cast<int>((x + k * dx) >> 16), static_cast<int>((y + k * dy) >> 16)));
    });
    EXPECT_EQ(visited, count);
  });
}

TEST(EvidenceMap, HasTheSmallestCellsThatAreFewEnough) {
  EvidenceMap map;
  for (const auto& [width, height] : {std::pair{2, 2},
                                      {315, 160},
                                      {640, 480},
                                      {800, 400},
                                      {802, 400},
                                      {1280, 720},
                                      {1920, 1080},
                                      {4000, 17}}) {
    const MapPicture picture{Canvas{width, height}};
    map.fill(picture.image, kOrange);
    const int step = map.step();
    ASSERT_GE(step, 2);
    EXPECT_EQ(map.width(), width / step);
    EXPECT_EQ(map.height(), height / step);
    EXPECT_LE(map.width() * map.height(), EvidenceMap::kCells) << width << " x " << height;
    EXPECT_TRUE(step == 2 || (width / (step - 1)) * (height / (step - 1)) > EvidenceMap::kCells);
  }
}

// Cells of two pixels, the mean of the square around each, the picture's colour asked for both.
TEST(EvidenceMap, IsThatOfEachCellsColourAndOfTheMeanAroundIt) {
  EvidenceMap map;
  const PictureColor color{kOrange};
  for_all(10, [&](Rng& rng) {
    const MapPicture picture{any_map_picture(rng)};
    const Image& image = picture.image;
    map.fill(image, color);
    const int width = map.width(), height = map.height(),
              radius = std::clamp(std::min(width, height) / 16, 5, 100);
    const auto middle = [](int a, int b) { return static_cast<std::uint8_t>((a + b + 1) / 2); };
    const auto cell = [&](int x, int y) -> Yuv {
      const Yuv a = image.at(2 * x, 2 * y), b = image.at(2 * x + 1, 2 * y + 1);
      return {middle(a.y, b.y), middle(a.u, b.u), middle(a.v, b.v)};
    };
    for (int k = 0; k < 200; ++k) {
      const int x = rng.uniform_index(width), y = rng.uniform_index(height);
      int count = 0;
      std::array<double, 3> sum{};
      for (int j = std::max(0, y - radius); j <= std::min(height - 1, y + radius); ++j)
        for (int i = std::max(0, x - radius); i <= std::min(width - 1, x + radius); ++i) {
          const Yuv c = cell(i, j);
          sum[0] += c.y, sum[1] += c.u, sum[2] += c.v, ++count;
        }
      const Yuv around = map.around(2 * x, 2 * y);
      ASSERT_NEAR(around.y, sum[0] / count, 0.51) << x << ", " << y;
      ASSERT_NEAR(around.u, sum[1] / count, 0.51) << x << ", " << y;
      ASSERT_NEAR(around.v, sum[2] / count, 0.51) << x << ", " << y;
      const int evidence =
          std::clamp(color.evidence(cell(x, y), around), -EvidenceMap::kLimit, EvidenceMap::kLimit);
      ASSERT_EQ(map.at(x, y), evidence) << x << ", " << y;
      ASSERT_EQ(map.row(y)[x], evidence) << x << ", " << y;
    }
  });
}

TEST(EvidenceMap, APartIsAsInAMapOfAllAndOutsideOfItThereIsNoGate) {
  EvidenceMap all, part;
  const PictureColor color{kOrange};
  for_all(30, [&](Rng& rng) {
    Canvas canvas = any_map_picture(rng);
    if (rng.uniform(0.0, 1.0) < 0.1) canvas = Canvas{900, 500}, canvas.add_noise(rng, 60.0, 60.0);
    const MapPicture picture{canvas};
    const Image& image = picture.image;
    const double left = rng.uniform(-40.0, image.width()), top = rng.uniform(-40.0, image.height());
    const SearchWindow window{
        left, top, left + rng.uniform(0.0, 120.0), top + rng.uniform(0.0, 120.0), 0.0, 1e3};
    all.fill(image, color), part.fill(image, color, &window);
    ASSERT_EQ(part.width(), all.width());
    const CellBox& cells = part.filled();
    const int step = part.step();
    for (int y = -1; y <= all.height(); ++y)
      for (int x = -1; x <= all.width(); ++x) {
        const bool wanted = step * (x + 1.0) > window.left && step * x <= window.right &&
                            step * (y + 1.0) > window.top && step * y <= window.bottom && x >= 0 &&
                            y >= 0 && x < all.width() && y < all.height();
        ASSERT_TRUE(!wanted || cells.contains(x, y)) << x << ", " << y;
        ASSERT_EQ(part.at(x, y), cells.contains(x, y) ? all.at(x, y) : EvidenceMap::kOutside);
        if (x >= all.width() || y >= all.height()) continue;
        ASSERT_EQ(part.at_pixel(image, color, step * x, step * y),
                  cells.contains(x, y) ? all.at_pixel(image, color, step * x, step * y)
                                       : EvidenceMap::kOutside);
      }
  });
}

TEST(EvidenceMap, ABarSpeaksForTheGateAndTheWallAgainstIt) {
  Canvas canvas{320, 160};
  canvas.paint(150, 156, 20, 140, kMapPaint);
  const MapPicture picture{canvas};
  const PictureColor color{kOrange};
  EvidenceMap map;
  map.fill(picture.image, color);
  for (int y = 12; y < 68; ++y) {
    EXPECT_GE(map.at(76, y), 16) << "a nat";
    EXPECT_LT(map.at(30, y), 0);
    EXPECT_LT(map.at(130, y), 0);
    EXPECT_GE(map.at_pixel(picture.image, color, 152, 2 * y), 16);
    EXPECT_LT(map.at_pixel(picture.image, color, 60, 2 * y), 0);
  }
}

TEST(EvidenceMap, OutsideThereIsNoneOfAGate) {
  Canvas canvas{40, 30};
  canvas.fill(kMapPaint);
  const MapPicture picture{canvas};
  const PictureColor color{kOrange};
  EvidenceMap map;
  map.fill(picture.image, color);
  for (const auto& [x, y] : {std::pair{-1, 3}, {3, -1}, {20, 3}, {3, 15}, {-1000, 1000}})
    EXPECT_EQ(map.at(x, y), EvidenceMap::kOutside) << x << ", " << y;
  for (const auto& [u, v] : {std::pair{-1, 3}, {3, -1}, {40, 3}, {3, 30}})
    EXPECT_EQ(map.at_pixel(picture.image, color, u, v), EvidenceMap::kOutside) << u << ", " << v;
  EXPECT_NE(map.at(19, 14), EvidenceMap::kOutside);
}

TEST(EvidenceMap, APictureWithoutACellIsAnEmptyMap) {
  const PictureColor color{kOrange};
  EvidenceMap map;
  const MapPicture first{Canvas{40, 30}};
  map.fill(first.image, color);
  const MapPicture thin{Canvas{1, 100}};
  for (const Image& image : {Image{}, thin.image}) {
    map.fill(image, color);
    EXPECT_EQ(map.width(), 0);
    EXPECT_EQ(map.height(), 0);
    EXPECT_EQ(map.at(0, 0), EvidenceMap::kOutside);
    EXPECT_EQ(map.at_pixel(image, color, 0, 0), EvidenceMap::kOutside);
  }
}

TEST(EvidenceMap, WhatWasReadBeforeLeavesNoTrace) {
  EvidenceMap used;
  for_all(10, [&](Rng& rng) {
    const MapPicture before{any_map_picture(rng)}, picture{any_map_picture(rng)};
    used.fill(before.image, kOrange);
    used.fill(picture.image, kOrange);
    EvidenceMap fresh;
    fresh.fill(picture.image, kOrange);
    ASSERT_EQ(used.width(), fresh.width());
    for (int y = 0; y < fresh.height(); ++y)
      for (int x = 0; x < fresh.width(); ++x) ASSERT_EQ(used.at(x, y), fresh.at(x, y));
  });
}

}  // namespace
}  // namespace gatefly
