// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/jpeg_chain.hpp"

#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

namespace gatefly::sim {
namespace {

/// Bytes that libjpeg allocates.
struct Encoded {
  Encoded() = default;
  ~Encoded() { std::free(bytes); }  // NOLINT(cppcoreguidelines-no-malloc): libjpeg allocated it
  Encoded(const Encoded&) = delete;
  Encoded& operator=(const Encoded&) = delete;

  unsigned char* bytes = nullptr;
  unsigned long size = 0;
};

void encode(const std::vector<std::uint8_t>& uyvy, int width, int height, int quality,
            Encoded& to) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  jpeg_mem_dest(&jpeg, &to.bytes, &to.size);
  jpeg.image_width = static_cast<JDIMENSION>(width);
  jpeg.image_height = static_cast<JDIMENSION>(height);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_YCbCr;
  jpeg_set_defaults(&jpeg);  // chroma of two by two pixels in one
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg.dct_method = JDCT_ISLOW;
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<std::uint8_t> line(3 * static_cast<std::size_t>(width));
  const std::uint8_t* in = uyvy.data();
  for (int y = 0; y < height; ++y) {
    for (std::size_t i = 0; i < line.size(); i += 6, in += 4) {
      line[i] = in[1], line[i + 1] = in[0], line[i + 2] = in[2];
      line[i + 3] = in[3], line[i + 4] = in[0], line[i + 5] = in[2];
    }
    JSAMPROW row = line.data();
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
}

void decode(const Encoded& from, std::vector<std::uint8_t>& uyvy) {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, from.bytes, from.size);
  jpeg_read_header(&jpeg, TRUE);
  jpeg.out_color_space = JCS_YCbCr;
  jpeg.dct_method = JDCT_ISLOW;
  jpeg_start_decompress(&jpeg);
  std::vector<std::uint8_t> line(3 * static_cast<std::size_t>(jpeg.output_width));
  std::uint8_t* out = uyvy.data();
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = line.data();
    jpeg_read_scanlines(&jpeg, &row, 1);
    const auto mean = [&](std::size_t a, std::size_t b) {
      return static_cast<std::uint8_t>((line[a] + line[b] + 1) / 2);
    };
    for (std::size_t i = 0; i < line.size(); i += 6, out += 4) {
      out[0] = mean(i + 1, i + 4), out[1] = line[i];
      out[2] = mean(i + 2, i + 5), out[3] = line[i + 3];
    }
  }
  jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
}

}  // namespace

void through_jpeg(std::vector<std::uint8_t>& uyvy, int width, int height, int quality) {
  Encoded encoded;
  encode(uyvy, width, height, quality, encoded);
  decode(encoded, uyvy);
}

}  // namespace gatefly::sim
