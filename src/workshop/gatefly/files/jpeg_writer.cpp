// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/jpeg_writer.hpp"

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <vector>

#include <jpeglib.h>

namespace gatefly::files {
namespace {

struct Compressor {
  Compressor() {
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &bytes, &size);
  }
  ~Compressor() {
    jpeg_destroy_compress(&jpeg);
    std::free(bytes);  // NOLINT(cppcoreguidelines-no-malloc): libjpeg allocated it
  }
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
};

// MPEG-1's default for intra blocks (ISO 11172-2), which FFmpeg's MJPEG scales.
constexpr std::array<unsigned, 64> kIntra{
    8,  16, 19, 22, 26, 27, 29, 34, 16, 16, 22, 24, 27, 29, 34, 37, 19, 22, 26, 27, 29, 34,
    34, 38, 22, 22, 26, 27, 29, 34, 37, 40, 22, 26, 27, 29, 32, 35, 40, 48, 26, 27, 29, 32,
    35, 40, 48, 58, 26, 27, 29, 34, 38, 46, 56, 69, 27, 29, 35, 38, 46, 56, 69, 83};
constexpr unsigned kLowQuality = 25;

void check_size(const Image& image, int step) {
  if (step < 1 || image.empty() || image.width() > JPEG_MAX_DIMENSION ||
      image.height() > JPEG_MAX_DIMENSION)
    throw std::invalid_argument("jpeg: no picture that a JPEG can hold");
}

void begin(Compressor& to, int width, int height) {
  to.jpeg.image_width = static_cast<JDIMENSION>(width);
  to.jpeg.image_height = static_cast<JDIMENSION>(height);
  to.jpeg.input_components = 3;
  to.jpeg.in_color_space = JCS_YCbCr;
  jpeg_set_defaults(&to.jpeg);
}

void write_lines(Compressor& to, const Image& image, int step) {
  const int width = static_cast<int>(to.jpeg.image_width);
  std::vector<std::uint8_t> line(3 * static_cast<std::size_t>(width));
  for (int v = 0; v < image.height(); v += step) {
    std::uint8_t* out = line.data();
    image.visit_row(0, v, step, width, [&out](Yuv color) {
      *out++ = color.y;
      *out++ = color.u;
      *out++ = color.v;
    });
    JSAMPROW row = line.data();
    jpeg_write_scanlines(&to.jpeg, &row, 1);
  }
  jpeg_finish_compress(&to.jpeg);
}

/// The least EXIF that says how a picture is to be turned.
void write_orientation(Compressor& to, int orientation) {
  std::array<unsigned char, 32> exif{'E', 'x', 'i', 'f', 0,    0,    'I', 'I', 42, 0, 8, 0,
                                     0,   0,   1,   0,   0x12, 0x01, 3,   0,   1,  0, 0, 0};
  exif[24] = static_cast<unsigned char>(orientation);
  jpeg_write_marker(&to.jpeg, JPEG_APP0 + 1, exif.data(), exif.size());
}

}  // namespace

std::string small_jpeg(const Image& image, int quality, int step) {
  check_size(image, step);
  // The sizes are checked: nothing is left that libjpeg could refuse.
  Compressor to;
  begin(to, (image.width() + step - 1) / step, (image.height() + step - 1) / step);
  jpeg_set_quality(&to.jpeg, quality, TRUE);
  to.jpeg.dct_method = JDCT_IFAST;
  jpeg_start_compress(&to.jpeg, TRUE);
  write_lines(to, image, step);
  return {reinterpret_cast<const char*>(to.bytes), to.size};
}

std::string jpeg_of(const Image& image, int quality, ChromaSampling sampling) {
  check_size(image, 1);
  Compressor to;
  begin(to, image.width(), image.height());
  jpeg_set_quality(&to.jpeg, quality, TRUE);
  const int shared = sampling == ChromaSampling::k420 ? 2 : 1;
  to.jpeg.comp_info[0].h_samp_factor = to.jpeg.comp_info[0].v_samp_factor = shared;
  to.jpeg.dct_method = JDCT_ISLOW;
  jpeg_start_compress(&to.jpeg, TRUE);
  write_lines(to, image, 1);
  return {reinterpret_cast<const char*>(to.bytes), to.size};
}

std::string recorded_jpeg(const Image& image, Recording recording, int exif_orientation) {
  check_size(image, 1);
  Compressor to;
  begin(to, image.width(), image.height());
  if (recording == Recording::kJpeg) {
    jpeg_set_quality(&to.jpeg, 98, TRUE);
  } else {
    std::array<unsigned, 64> table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = kIntra[i] * kLowQuality / 8;
    table[0] = kIntra[0];  // FFmpeg leaves the mean alone
    for (const int slot : {0, 1}) jpeg_add_quant_table(&to.jpeg, slot, table.data(), 100, TRUE);
  }
  to.jpeg.comp_info[0].h_samp_factor = 2, to.jpeg.comp_info[0].v_samp_factor = 1;
  to.jpeg.dct_method = JDCT_ISLOW;
  jpeg_start_compress(&to.jpeg, TRUE);
  if (exif_orientation > 0) write_orientation(to, exif_orientation);
  write_lines(to, image, 1);
  return {reinterpret_cast<const char*>(to.bytes), to.size};
}

}  // namespace gatefly::files
