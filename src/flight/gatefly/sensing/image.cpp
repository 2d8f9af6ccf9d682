// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sensing/image.hpp"

#include <algorithm>

namespace gatefly {

std::size_t image_bytes(PixelFormat format, int stored_width, int stored_height) {
  if (stored_width <= 0 || stored_height <= 0) return 0;
  const auto pixels =
      static_cast<std::size_t>(stored_width) * static_cast<std::size_t>(stored_height);
  return format == PixelFormat::kUyvy ? 2 * pixels : 3 * pixels;
}

Yuv yuv_of_rgb(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  // JFIF 1.02 in 16-bit fixed point; + 0.5 for rounding.
  const auto clamped = [](int fixed) {
    return static_cast<std::uint8_t>(std::clamp((fixed + 32768) >> 16, 0, 255));
  };
  return {clamped(19595 * r + 38470 * g + 7471 * b),
          clamped(-11059 * r - 21709 * g + 32768 * b + (128 << 16)),
          clamped(32768 * r - 27439 * g - 5329 * b + (128 << 16))};
}

Image::Image(const std::uint8_t* bytes, PixelFormat format, int stored_width, int stored_height,
             int stored_rotation_deg)
    : bytes_{bytes}, format_{format}, along_v_{stored_width} {
  if (bytes == nullptr || stored_width <= 0 || stored_height <= 0) return;
  if (format == PixelFormat::kUyvy && stored_width % 2 != 0) return;  // pairs cannot be halved
  width_ = stored_width;
  height_ = stored_height;
  const std::ptrdiff_t line = stored_width, last_line = line * (stored_height - 1);
  switch (stored_rotation_deg) {
    case 90:  // the stored right edge becomes the top
      width_ = stored_height, height_ = stored_width;
      first_ = line - 1, along_u_ = line, along_v_ = -1;
      break;
    case 180:
      first_ = last_line + line - 1, along_u_ = -1, along_v_ = -line;
      break;
    case 270:
      width_ = stored_height, height_ = stored_width;
      first_ = last_line, along_u_ = -line, along_v_ = 1;
      break;
    default:
      break;
  }
}

}  // namespace gatefly
