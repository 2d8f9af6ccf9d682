// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/image_file.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <jpeglib.h>
#include <png.h>

#include "support/temp_folder.hpp"

namespace gatefly::files {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A JPEG of one Y'CbCr colour (or of one grey), 16 x 8 px.
std::string flat_jpeg(JSAMPLE y, JSAMPLE cb, JSAMPLE cr, bool grey = false) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = 16;
  jpeg.image_height = 8;
  jpeg.input_components = grey ? 1 : 3;
  jpeg.in_color_space = grey ? JCS_GRAYSCALE : JCS_YCbCr;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  std::string line;
  for (int i = 0; i < 16; ++i)
    line += grey ? std::string{static_cast<char>(y)}
                 : std::string{static_cast<char>(y), static_cast<char>(cb), static_cast<char>(cr)};
  for (int i = 0; i < 8; ++i) {
    auto* row = reinterpret_cast<JSAMPROW>(line.data());
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::string file(reinterpret_cast<char*>(bytes), size);
  std::free(bytes);
  return file;
}

/// With an EXIF marker of one entry, the orientation, in either byte order.
std::string with_exif(const std::string& jpeg, char orientation, bool little) {
  using namespace std::string_literals;
  const std::string tiff =
      little ? "II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"s + orientation + "\0\0\0"s
             : "MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0"s + orientation + "\0\0"s;
  return jpeg.substr(0, 2) + "\xFF\xE1\0"s + static_cast<char>(8 + tiff.size()) + "Exif\0\0"s +
         tiff + jpeg.substr(2);
}

/// A PNG of one row of pixels in a format of libpng's.
std::string encoded_png(std::uint32_t format, const std::string& pixels) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.format = format;
  png.width = static_cast<png_uint_32>(pixels.size() / PNG_IMAGE_PIXEL_SIZE(format));
  png.height = 1;
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&png, nullptr, &size, 0, pixels.data(), 0, nullptr);
  std::string file(size, '\0');
  png_image_write_to_memory(&png, file.data(), &size, 0, pixels.data(), 0, nullptr);
  return file;
}

std::string error_reading(const std::string& name, const std::string& content, int width = 0,
                          int height = 0) {
  const test::TempFolder folder;
  const auto path = folder.file(name, content);
  return test::error_of([&] { (void)read_image(path, width, height); });
}

TEST(ImageFile, JpegKeepsItsOwnColoursFullRange) {
  const test::TempFolder folder;
  const ImageFile file = read_image(folder.file("a.JPG", flat_jpeg(250, 60, 200)));
  EXPECT_EQ(file.stored_width, 16);
  EXPECT_EQ(file.stored_height, 8);
  const Yuv c = file.view(0).at(7, 3);
  EXPECT_NEAR(c.y, 250, 1);
  EXPECT_NEAR(c.u, 60, 1);
  EXPECT_NEAR(c.v, 200, 1);
}

TEST(ImageFile, AJpegsExifSaysHowItWasHeld) {
  const test::TempFolder folder;
  const std::string plain = flat_jpeg(100, 110, 120);
  EXPECT_EQ(read_image(folder.file("a.jpg", plain)).exif_orientation, 0);
  for (const bool little : {false, true})
    for (char orientation = 0; orientation < 10; ++orientation)
      EXPECT_EQ(
          read_image(folder.file("a.jpg", with_exif(plain, orientation, little))).exif_orientation,
          orientation > 8 ? 0 : orientation);
  EXPECT_EQ(exif_rotation_deg(1), 0);
  EXPECT_EQ(exif_rotation_deg(3), 180);
  EXPECT_EQ(exif_rotation_deg(6), 270);  // "turn it clockwise by 90 degrees"
  EXPECT_EQ(exif_rotation_deg(8), 90);
  EXPECT_EQ(exif_rotation_deg(2), std::nullopt);
}

TEST(ImageFile, GreyJpegIsNeutral) {
  const test::TempFolder folder;
  const ImageFile file = read_image(folder.file("a.jpeg", flat_jpeg(77, 0, 0, true)));
  const Yuv c = file.view(90).at(2, 2);
  EXPECT_NEAR(c.y, 77, 1);
  EXPECT_EQ(c.u, 128);
  EXPECT_EQ(c.v, 128);
}

TEST(ImageFile, EveryTruncationOfAJpegIsAnErrorAndNeverACrash) {
  const test::TempFolder folder;
  // The bytes after "Exif" are a stranger's: every length of it, and a list that would lie
  // elsewhere.
  const std::string photo = with_exif(flat_jpeg(100, 110, 120), 6, true);
  for (std::size_t left = 0; left < 22; ++left) {
    std::string cut = photo;
    cut.erase(12 + left, 22 - left);
    cut[5] = static_cast<char>(8 + left);
    EXPECT_EQ(read_image(folder.file("cut.jpg", cut)).exif_orientation, 0) << left;
  }
  std::string far_off = photo;
  far_off[16] = '\x70';
  EXPECT_EQ(read_image(folder.file("far.jpg", far_off)).exif_orientation, 0);

  const std::string whole = flat_jpeg(100, 110, 120);
  for (std::size_t size = 0; size < whole.size() - 2; size += 7)
    EXPECT_THAT(error_reading("a.jpg", whole.substr(0, size)),
                AllOf(HasSubstr("a.jpg"), Not(HasSubstr("\n"))))
        << size;
}

/// A picture that is whole, or an error of one line with the file's name; never half of either.
void expect_a_picture_or_a_reason(const std::string& name, const std::string& content) {
  const test::TempFolder folder;
  const auto path = folder.file(name, content);
  ImageFile file;
  const std::string error = test::error_of([&] { file = read_image(path); });
  if (error.empty())
    EXPECT_EQ(file.bytes.size(), image_bytes(file.format, file.stored_width, file.stored_height));
  else
    EXPECT_THAT(error, AllOf(HasSubstr(name), Not(HasSubstr("\n"))));
}

TEST(ImageFile, AnyDamagedByteIsReadOrRefusedButNeverCrashes) {
  const std::string whole = flat_jpeg(100, 110, 120);
  for (std::size_t at = 2; at < whole.size(); at += 3) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5A);
    expect_a_picture_or_a_reason("a.jpg", damaged);
  }
}

TEST(ImageFile, PngOfAnyKindIsRgb) {
  const test::TempFolder folder;
  const auto first = [&](std::uint32_t format, const std::string& pixels) {
    return read_image(folder.file("a.png", encoded_png(format, pixels))).view(0).at(1, 0);
  };
  const Yuv orange = yuv_of_rgb(0xff, 0x80, 0x20);
  EXPECT_EQ(first(PNG_FORMAT_RGB, "abc\xff\x80\x20").v, orange.v);
  EXPECT_EQ(first(PNG_FORMAT_RGBA, "abc\xff\xff\x80\x20\xff").u, orange.u);
  const Yuv grey = first(PNG_FORMAT_GRAY, "aMb");
  EXPECT_EQ(grey.y, 'M');
  EXPECT_EQ(grey.u, 128);
}

TEST(ImageFile, EveryTruncationOfAPngIsAnErrorAndNeverACrash) {
  const std::string whole = encoded_png(PNG_FORMAT_RGB, "abcdefghi");
  // the last 12 bytes only say that it ends
  for (std::size_t size = 0; size + 12 < whole.size(); ++size)
    EXPECT_THAT(error_reading("a.png", whole.substr(0, size)),
                AllOf(HasSubstr("a.png"), Not(HasSubstr("\n"))))
        << size;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5A);
    expect_a_picture_or_a_reason("a.png", damaged);
  }
}

TEST(ImageFile, PpmIsRgb) {
  const test::TempFolder folder;
  const ImageFile file =
      read_image(folder.file("a.ppm", "P6\n# made by hand\n2 1\n255\n\xff\x80\x20zzz"));
  EXPECT_EQ(file.format, PixelFormat::kRgb);
  EXPECT_EQ(file.view(0).at(0, 0).y, yuv_of_rgb(0xff, 0x80, 0x20).y);
  EXPECT_EQ(file.view(90).width(), 1);
}

TEST(ImageFile, BrokenPpmIsRefused) {
  EXPECT_THAT(error_reading("a.ppm", "P5\n2 1\n255\n123456"), HasSubstr("P6"));
  EXPECT_THAT(error_reading("a.ppm", "P6\n2 1\n255\n12345"), HasSubstr("ends early"));
  EXPECT_THAT(error_reading("a.ppm", "P6\n2 1\n65535\n123456"), HasSubstr("255"));
  EXPECT_THAT(error_reading("a.ppm", "P6\n0 1\n255\n"), HasSubstr("size"));
  EXPECT_THAT(error_reading("a.ppm", "P6 #"), HasSubstr("header"));
  EXPECT_THAT(error_reading("a.ppm", "P6\n99999 99999\n255\n"), HasSubstr("size"));
}

TEST(ImageFile, UyvyNeedsExactlyTheCamerasBytes) {
  const test::TempFolder folder;
  const ImageFile file = read_image(folder.file("a.uyvy", "U1V2u3v4"), 2, 2);
  EXPECT_EQ(file.view(0).at(1, 1).y, '4');
  EXPECT_EQ(file.view(0).at(1, 1).u, 'u');
  EXPECT_THAT(error_reading("a.uyvy", "U1V2u3v", 2, 2), HasSubstr("has 7 bytes, must be 8"));
  EXPECT_THAT(error_reading("a.uyvy", "U1V2u3v4"), HasSubstr("stored size"));
}

TEST(ImageFile, OtherEmptyMissingAndFolderAreErrorsWithThePath) {
  EXPECT_THAT(error_reading("a.jpg", ""), HasSubstr("a.jpg: is empty"));
  EXPECT_THAT(error_reading("a.txt", "x"), HasSubstr("a.txt: not a picture"));
  EXPECT_THAT(error_reading("a.jpg", "certainly no jpeg"), HasSubstr("not a usable JPEG"));
  EXPECT_THAT(test::error_of([] { (void)read_image("/nowhere/a.jpg"); }),
              HasSubstr("/nowhere/a.jpg"));
  const test::TempFolder folder;
  std::filesystem::create_directory(folder.path() / "b.jpg");
  EXPECT_THAT(test::error_of([&] { (void)read_image(folder.path() / "b.jpg"); }),
              HasSubstr("is a folder"));
}

}  // namespace
}  // namespace gatefly::files
