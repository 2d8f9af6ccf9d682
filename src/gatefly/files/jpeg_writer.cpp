// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/jpeg_writer.hpp"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <vector>

#include <jpeglib.h>

namespace gatefly::io {
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

}  // namespace

std::string small_jpeg(const Image& image, int quality, int step) {
  if (step < 1 || image.empty() || image.width() > JPEG_MAX_DIMENSION ||
      image.height() > JPEG_MAX_DIMENSION)
    throw std::invalid_argument("small_jpeg: no picture that a JPEG can hold");
  const int width = (image.width() + step - 1) / step, height = (image.height() + step - 1) / step;

  // The sizes are checked: nothing is left that libjpeg could refuse.
  Compressor to;
  to.jpeg.image_width = static_cast<JDIMENSION>(width);
  to.jpeg.image_height = static_cast<JDIMENSION>(height);
  to.jpeg.input_components = 3;
  to.jpeg.in_color_space = JCS_YCbCr;
  jpeg_set_defaults(&to.jpeg);
  jpeg_set_quality(&to.jpeg, quality, TRUE);
  to.jpeg.dct_method = JDCT_IFAST;
  jpeg_start_compress(&to.jpeg, TRUE);
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
  return {reinterpret_cast<const char*>(to.bytes), to.size};
}

}  // namespace gatefly::io
