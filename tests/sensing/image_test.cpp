// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sensing/image.hpp"

#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/sensing/color_range.hpp"

namespace gatefly {
namespace {

TEST(Image, TheDefaultAndTheImpossibleAreEmpty) {
  const std::uint8_t byte = 0;
  EXPECT_TRUE(Image{}.empty());
  EXPECT_TRUE(Image(nullptr, PixelFormat::kYuv444, 4, 4).empty());
  EXPECT_TRUE(Image(&byte, PixelFormat::kYuv444, 0, 4).empty());
  EXPECT_TRUE(Image(&byte, PixelFormat::kYuv444, 4, -1).empty());
  EXPECT_FALSE(Image{}.contains(0, 0));
}

TEST(Image, BytesOfAPicture) {
  EXPECT_EQ(image_bytes(PixelFormat::kUyvy, 160, 315), 160u * 315 * 2);
  EXPECT_EQ(image_bytes(PixelFormat::kRgb, 10, 3), 90u);
  EXPECT_EQ(image_bytes(PixelFormat::kYuv444, -1, 3), 0u);
}

// A 3 x 2 picture whose Y says where it is stored: 10 * row + column.
std::vector<std::uint8_t> numbered() {
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x)
      bytes.insert(bytes.end(), {static_cast<std::uint8_t>(10 * y + x), 100, 200});
  return bytes;
}

TEST(Image, ARowVisitsWhatIsThere) {
  std::vector<std::uint8_t> bytes(3 * 8 * 6);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(37 * i);
  for (const PixelFormat format : {PixelFormat::kUyvy, PixelFormat::kRgb, PixelFormat::kYuv444})
    for (const int turn : {0, 90, 180, 270}) {
      const Image image{bytes.data(), format, 8, 6, turn};
      for (int v = 0; v < image.height(); ++v) {
        int u = 1;
        image.visit_row(1, v, 2, (image.width() - 1) / 2, [&](Yuv c) {
          const Yuv same = image.at(u, v);
          EXPECT_TRUE(c.y == same.y && c.u == same.u && c.v == same.v)
              << turn << " deg, " << u << ", " << v;
          u += 2;
        });
        EXPECT_EQ(u, 1 + (image.width() - 1) / 2 * 2);
      }
    }
}

// Exactly as many bytes as the picture has: a sanitizer sees what is read beyond them.
TEST(Image, PackedPixelsAreThoseThatAreThere) {
  std::vector<std::uint8_t> bytes(3 * 8 * 6);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(37 * i);
  for (const PixelFormat format : {PixelFormat::kUyvy, PixelFormat::kRgb, PixelFormat::kYuv444})
    for (const int turn : {0, 90, 180, 270})
      for (const int first : {0, 1})
        for (const int step : {1, 2}) {
          const Image image{bytes.data(), format, 8, 6, turn};
          const int pairs = (image.width() - first) / (2 * step);
          for (int v = 0; v < image.height(); ++v) {
            int u = first;
            image.visit_row_packed<2>(first, v, step, pairs,
                                      [&](const std::array<PackedYuv, 2>& c) {
                                        for (const PackedYuv& one : c) {
                                          const PackedYuv same = PackedYuv::of(image.at(u, v));
                                          EXPECT_TRUE(one.y == same.y && one.uv == same.uv)
                                              << turn << " deg, " << u << ", " << v;
                                          const PackedYuv alone = image.packed_at(u, v);
                                          EXPECT_TRUE(alone.y == same.y && alone.uv == same.uv)
                                              << turn << " deg, " << u << ", " << v;
                                          u += step;
                                        }
                                      });
            EXPECT_EQ(u, first + 2 * step * pairs);
          }
        }
}

TEST(Image, IsAddressedUprightHoweverItIsStored) {
  const auto bytes = numbered();
  const Image as_is{bytes.data(), PixelFormat::kYuv444, 3, 2, 0};
  EXPECT_EQ(as_is.at(2, 1).y, 12);
  EXPECT_EQ(as_is.at(2, 1).u, 100);
  EXPECT_EQ(as_is.at(2, 1).v, 200);

  // Turned 90° counter-clockwise: the right edge becomes the top, the top becomes the left.
  const Image turned{bytes.data(), PixelFormat::kYuv444, 3, 2, 90};
  EXPECT_EQ(turned.width(), 2);
  EXPECT_EQ(turned.height(), 3);
  EXPECT_EQ(turned.at(0, 0).y, 2);
  EXPECT_EQ(turned.at(1, 0).y, 12);
  EXPECT_EQ(turned.at(0, 2).y, 0);

  const Image upside_down{bytes.data(), PixelFormat::kYuv444, 3, 2, 180};
  EXPECT_EQ(upside_down.at(0, 0).y, 12);

  const Image other{bytes.data(), PixelFormat::kYuv444, 3, 2, 270};
  EXPECT_EQ(other.width(), 2);
  EXPECT_EQ(other.at(0, 0).y, 10);
  EXPECT_EQ(other.at(0, 2).y, 12);
  EXPECT_EQ(other.at(1, 0).y, 0);
}

TEST(Image, AnUnknownTurnActsAsNone) {
  const auto bytes = numbered();
  const Image image{bytes.data(), PixelFormat::kYuv444, 3, 2, 45};
  EXPECT_EQ(image.width(), 3);
  EXPECT_EQ(image.at(1, 1).y, 11);
}

TEST(Image, PairsOfUyvyShareTheirChroma) {
  const std::vector<std::uint8_t> bytes{50, 1, 60, 2, 70, 3, 80, 4};  // U Y V Y, U Y V Y
  const Image image{bytes.data(), PixelFormat::kUyvy, 4, 1};
  for (int u = 0; u < 4; ++u) {
    EXPECT_EQ(image.at(u, 0).y, u + 1);
    EXPECT_EQ(image.at(u, 0).u, u < 2 ? 50 : 70);
    EXPECT_EQ(image.at(u, 0).v, u < 2 ? 60 : 80);
  }
}

// A lone last column has no V of its own: it would be read from behind the buffer.
TEST(Image, UyvyOfOddWidthIsNoPicture) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{3, 1}, std::pair{3, 3}}) {
    const std::vector<std::uint8_t> bytes(image_bytes(PixelFormat::kUyvy, width, height), 20);
    for (const int turn : {0, 90, 180, 270})
      EXPECT_TRUE((Image{bytes.data(), PixelFormat::kUyvy, width, height, turn}).empty())
          << width << " x " << height;
  }
  const std::vector<std::uint8_t> bytes(image_bytes(PixelFormat::kUyvy, 2, 3), 20);
  EXPECT_FALSE((Image{bytes.data(), PixelFormat::kUyvy, 2, 3}).empty()) << "odd heights may be";
}

TEST(Yuv, OfRgbFollowsJfif) {
  const Yuv black = yuv_of_rgb(0, 0, 0), white = yuv_of_rgb(255, 255, 255),
            red = yuv_of_rgb(255, 0, 0), blue = yuv_of_rgb(0, 0, 255);
  EXPECT_EQ(black.y, 0);
  EXPECT_EQ(white.y, 255);
  for (int grey = 0; grey < 256; ++grey) {
    const auto g = static_cast<std::uint8_t>(grey);
    const Yuv c = yuv_of_rgb(g, g, g);
    EXPECT_EQ(c.y, grey);
    EXPECT_EQ(c.u, 128);
    EXPECT_EQ(c.v, 128);
  }
  EXPECT_EQ(red.y, 76);
  EXPECT_EQ(red.u, 85);
  EXPECT_EQ(red.v, 255) << "255.5, clamped";
  EXPECT_EQ(blue.u, 255);
}

TEST(ColorRange, BoundsBelongToItAndGreyDoesNot) {
  const ColorRange range{.y_min = 30,
                         .y_max = 250,
                         .u_min = 30,
                         .u_max = 126,
                         .v_min = 132,
                         .v_max = 240,
                         .min_chroma = 0};
  EXPECT_TRUE(range.contains({30, 30, 132}));
  EXPECT_TRUE(range.contains({250, 126, 240}));
  EXPECT_FALSE(range.contains({29, 100, 180}));
  EXPECT_FALSE(range.contains({100, 127, 180}));
  EXPECT_FALSE(range.contains({100, 128, 128}));
  ColorRange saturated = range;
  saturated.min_chroma = 50;
  EXPECT_TRUE(saturated.contains({100, 98, 168})) << "30, 40: exactly 50 from grey";
  EXPECT_FALSE(saturated.contains({100, 99, 168}));
}

}  // namespace
}  // namespace gatefly
