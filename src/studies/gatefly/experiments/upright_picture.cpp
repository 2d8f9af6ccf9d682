// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/upright_picture.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gatefly::experiments {

std::array<double, 3> ycc_of(const std::array<double, 3>& rgb) {
  const auto [r, g, b] = rgb;
  const double y = 0.299 * r + 0.587 * g + 0.114 * b;
  return {y, 128.0 + (b - y) / 1.772, 128.0 + (r - y) / 1.402};
}

std::array<double, 3> rgb_of(const std::array<double, 3>& ycc) {
  const auto [y, cb, cr] = ycc;
  const double r = y + 1.402 * (cr - 128.0), b = y + 1.772 * (cb - 128.0);
  return {r, (y - 0.299 * r - 0.114 * b) / 0.587, b};
}

std::uint8_t rounded(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

UprightPicture upright_rgb(const Image& image, std::vector<Quad> gates, std::vector<Quad> ignored) {
  UprightPicture picture{.width = image.width(),
                         .height = image.height(),
                         .gates = std::move(gates),
                         .ignored = std::move(ignored)};
  picture.bytes.reserve(image_bytes(PixelFormat::kRgb, image.width(), image.height()));
  for (int v = 0; v < image.height(); ++v)
    image.visit_row(0, v, 1, image.width(), [&](Yuv c) {
      for (const double value : rgb_of({double(c.y), double(c.u), double(c.v)}))
        picture.bytes.push_back(rounded(value));
    });
  return picture;
}

}  // namespace gatefly::experiments
