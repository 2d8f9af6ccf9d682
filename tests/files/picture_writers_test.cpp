// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/files/image_file.hpp"
#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/png_writer.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::files {
namespace {

/// A soft slope of grey and colour, 24 x 16, as UYVY.
std::vector<std::uint8_t> slope() {
  std::vector<std::uint8_t> uyvy;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; x += 2) {
      uyvy.push_back(static_cast<std::uint8_t>(100 + x));
      uyvy.push_back(static_cast<std::uint8_t>(60 + 4 * x + y));
      uyvy.push_back(static_cast<std::uint8_t>(150 - y));
      uyvy.push_back(static_cast<std::uint8_t>(60 + 4 * (x + 1) + y));
    }
  return uyvy;
}

/// Content of a JPEG's marker, without its length field.
std::string segment(const std::string& jpeg, unsigned char marker) {
  for (std::size_t i = 2; i + 4 < jpeg.size();) {
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(jpeg[at]); };
    const std::size_t length = 256u * byte(i + 2) + byte(i + 3);
    if (byte(i + 1) == marker) return jpeg.substr(i + 4, length - 2);
    i += 2 + length;
  }
  return "";
}

TEST(RecordedJpeg, TheLowOneHasTheTableAndSamplingOfTheAuthorsRecording) {
  const auto bytes = slope();
  const Image image{bytes.data(), PixelFormat::kUyvy, 24, 16, 0};
  const std::string jpeg = recorded_jpeg(image, Recording::kMjpegLow);
  // As their basement580 has them: 8, then MPEG-1's 16 16 19 16 19 22 22 times 25 / 8.
  const std::string table = segment(jpeg, 0xDB);
  ASSERT_GE(table.size(), 9u);
  for (const auto& [at, value] :
       {std::pair{1, 8}, {2, 50}, {3, 50}, {4, 59}, {5, 50}, {6, 59}, {7, 68}, {8, 68}})
    EXPECT_EQ(static_cast<unsigned char>(table[static_cast<std::size_t>(at)]), value) << at;
  const std::string frame = segment(jpeg, 0xC0);
  EXPECT_EQ(frame[7], 0x21);
  EXPECT_EQ(frame[10], 0x11);
  EXPECT_EQ(frame[13], 0x11);
}

TEST(RecordedJpeg, TheCarefulOneKeepsThePictureAndSaysHowItIsTurned) {
  const test::TempFolder folder;
  const auto bytes = slope();
  const Image image{bytes.data(), PixelFormat::kUyvy, 24, 16, 0};
  write_file(folder.path() / "a.jpg", recorded_jpeg(image, Recording::kJpeg, 8));
  const ImageFile file = read_image(folder.path() / "a.jpg");
  EXPECT_EQ(file.exif_orientation, 8);
  EXPECT_EQ(file.stored_width, 24);
  const Image again = file.view(0);
  for (int v = 0; v < 16; ++v)
    for (int u = 0; u < 24; ++u) {
      EXPECT_NEAR(again.at(u, v).y, image.at(u, v).y, 3);
      EXPECT_NEAR(again.at(u, v).u, image.at(u, v).u, 4);
    }
  write_file(folder.path() / "b.jpg", recorded_jpeg(image, Recording::kJpeg));
  EXPECT_EQ(read_image(folder.path() / "b.jpg").exif_orientation, 0);
}

TEST(PngWriter, WhatIsWrittenIsReadAgain) {
  const test::TempFolder folder;
  const auto bytes = slope();
  const Image image{bytes.data(), PixelFormat::kUyvy, 24, 16, 90};
  write_file(folder.path() / "a.png", png_of(image));
  const ImageFile file = read_image(folder.path() / "a.png");
  ASSERT_EQ(file.stored_width, 16);
  const Image again = file.view(0);
  for (int v = 0; v < 24; ++v)
    for (int u = 0; u < 16; ++u) EXPECT_NEAR(again.at(u, v).y, image.at(u, v).y, 1);
}

}  // namespace
}  // namespace gatefly::files
