// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/sensing/color_range.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// "Is this pixel the gate's colour?", tested when asked. Outside the picture nothing is.
class ColorMask {
 public:
  ColorMask(const Image& image, const ColorRange& color) : image_{image}, color_{color} {}

  [[nodiscard]] bool operator()(int u, int v) const {
    return image_.contains(u, v) && color_.contains(image_.at(u, v));
  }
  [[nodiscard]] int width() const { return image_.width(); }
  [[nodiscard]] int height() const { return image_.height(); }

 private:
  Image image_;
  ColorRange color_;
};

}  // namespace gatefly
