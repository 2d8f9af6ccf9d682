// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/annotate.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::drawing {
namespace {

using ::testing::HasSubstr;

/// Grey, as a turned camera stores it.
struct Picture {
  int stored_width, stored_height, rotation_deg = 0;
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(
      image_bytes(PixelFormat::kYuv444, stored_width, stored_height), 128);
  [[nodiscard]] Image view() const {
    return Image(bytes.data(), PixelFormat::kYuv444, stored_width, stored_height, rotation_deg);
  }
};

GateDetection square(double from, double to, double fitness) {
  return {.corners_px = {{{from, from}, {to, from}, {to, to}, {from, to}}}, .fitness = fitness};
}

/// Width and height as a PNG's first chunk says (bytes 16 to 23, big-endian).
std::array<int, 2> png_size(const std::string& file) {
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = at; i < at + 4; ++i)
      value = 256 * value + static_cast<unsigned char>(file.at(i));
    return value;
  };
  EXPECT_EQ(file.substr(1, 3), "PNG");
  return {number(16), number(20)};
}

std::array<int, 2> annotated_size(const Picture& picture) {
  const test::TempFolder folder;
  const std::array<GateDetection, 1> gates{square(5, 40, 0.9)};
  annotated(picture.view(), gates).write_png(folder.path() / "a.png");
  return png_size(files::read_file(folder.path() / "a.png"));
}

TEST(Annotate, SmallPicturesAreTrebledUpright) {
  EXPECT_EQ(annotated_size({160, 315, 90}), (std::array{945, 480}));
}

TEST(Annotate, NoSideIsLongerThan1600) {
  EXPECT_EQ(annotated_size({640, 480}), (std::array{1280, 960}));
  EXPECT_EQ(annotated_size({1500, 100}), (std::array{1500, 100}));
  EXPECT_EQ(annotated_size({3200, 2400}), (std::array{1600, 1200}));
  EXPECT_EQ(annotated_size({4, 6400}), (std::array{1, 1600}));
}

TEST(Annotate, TheFileShowsWhatWasFound) {
  const test::TempFolder folder;
  const Picture picture{.stored_width = 100, .stored_height = 60};
  const std::array<GateDetection, 2> gates{square(20, 40, 0.9), square(50, 58, 0.7)};
  const auto file = [&](std::size_t count) {
    annotated(picture.view(), std::span{gates}.first(count)).write_png(folder.path() / "a.png");
    return files::read_file(folder.path() / "a.png");
  };
  EXPECT_NE(file(0), file(1));
  EXPECT_NE(file(1), file(2));
  EXPECT_EQ(file(2), file(2));
}

TEST(Annotate, DetectionsMeetThePixelsTheyMean) {
  Canvas canvas(90, 90, {0, 0, 0});
  draw_detection(canvas, square(5, 20, 0.9), {0, 0}, 3.0, {.color = {1, 1, 1}, .width = 1.0});
  const auto rgb = canvas.rgb();
  const auto red = [&](std::size_t x, std::size_t y) { return rgb[3 * (90 * y + x)]; };
  // Pixel (5, 5) covers 15..17 of the enlarged picture: its middle is 16, and so the lines'.
  EXPECT_GT(red(40, 16), 200);
  EXPECT_GT(red(61, 40), 200);
  EXPECT_EQ(red(40, 40), 0);
  EXPECT_EQ(red(75, 40), 0);
}

TEST(Annotate, GatesOutsideThePictureDoNoHarm) {
  const test::TempFolder folder;
  const Picture picture{.stored_width = 30, .stored_height = 20};
  const std::array<GateDetection, 1> gates{square(-500, 900, 0.5)};
  annotated(picture.view(), gates).write_png(folder.path() / "a.png");
  EXPECT_EQ(png_size(files::read_file(folder.path() / "a.png")), (std::array{90, 60}));
}

TEST(Annotate, WhatCannotBeWrittenLeavesNothing) {
  const test::TempFolder folder;
  const Picture picture{.stored_width = 30, .stored_height = 20};
  const auto error_at = [&](const std::filesystem::path& path, const Image& image) {
    return test::error_of([&] { annotated(image, {}).write_png(path); });
  };
  EXPECT_THAT(error_at(folder.path() / "missing" / "a.png", picture.view()),
              HasSubstr("a.png: cannot be written"));
  EXPECT_THAT(error_at(folder.path() / "a.png", Image{}), HasSubstr("the picture is empty"));
  // root may write anywhere, but not over a folder
  std::filesystem::create_directory(folder.path() / "taken.png");
  EXPECT_THAT(error_at(folder.path() / "taken.png", picture.view()),
              HasSubstr("taken.png: cannot be written"));
  std::filesystem::remove(folder.path() / "taken.png");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace gatefly::drawing
