// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gatefly/detection/quad.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::experiments {

/// An upright picture that may be changed, and the gates in it.
struct UprightPicture {
  int width = 0, height = 0;
  PixelFormat format = PixelFormat::kRgb;  ///< kRgb; what a JPEG decodes to is kYuv444.
  std::vector<std::uint8_t> bytes = {};    ///< Three a pixel, line by line.
  std::vector<Quad> gates = {}, ignored = {};

  [[nodiscard]] Image view() const { return Image(bytes.data(), format, width, height); }
  [[nodiscard]] std::size_t at(int u, int v) const {
    return 3 * (static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(u));
  }
};

/// A picture of any layout in 8-bit RGB, upright.
[[nodiscard]] UprightPicture upright_rgb(const Image& image, std::vector<Quad> gates = {},
                                         std::vector<Quad> ignored = {});

/// JFIF, each 0..255: Y, Cb, Cr of R, G, B and back. Neither rounded nor cut.
[[nodiscard]] std::array<double, 3> ycc_of(const std::array<double, 3>& rgb);
[[nodiscard]] std::array<double, 3> rgb_of(const std::array<double, 3>& ycc);

/// To the nearest of 0..255.
[[nodiscard]] std::uint8_t rounded(double value);

}  // namespace gatefly::experiments
