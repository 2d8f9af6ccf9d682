// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/png_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <png.h>

namespace gatefly::files {
namespace {

/// JFIF 1.02, full range.
void append_rgb(std::vector<std::uint8_t>& rgb, const Yuv& c) {
  const double y = c.y, u = c.u - 128.0, v = c.v - 128.0;
  for (const double part : {y + 1.402 * v, y - 0.344136 * u - 0.714136 * v, y + 1.772 * u})
    rgb.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(part), 0L, 255L)));
}

}  // namespace

std::string png_of(const Image& image) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * static_cast<std::size_t>(image.width() * image.height()));
  for (int v = 0; v < image.height(); ++v)
    image.visit_row(0, v, 1, image.width(), [&](Yuv color) { append_rgb(rgb, color); });
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width());
  png.height = static_cast<png_uint_32>(image.height());
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
    throw std::runtime_error(std::string{"png: "} + png.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace gatefly::files
