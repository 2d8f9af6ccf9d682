// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/picture_color.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/evidence_map.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// A picture as the careful search sees it, pixel by pixel: what colours are fitted to.
class PixelEvidence {
 public:
  /// Both must stay until the next read(): they are asked again.
  void read(const Image& image, const ColorModel& color);

  /// Whether the picture is too small to say anything; then nothing else may be asked.
  [[nodiscard]] bool empty() const { return map_.width() == 0; }
  /// Mean colour around a pixel in the picture.
  [[nodiscard]] Yuv around(int u, int v) const { return map_.around(u, v); }
  /// Evidence of a pixel by the colour model.
  [[nodiscard]] const PictureColor& color() const { return color_; }
  /// How much a pixel speaks for the gate, in 1 / ColorModel::kUnit nats.
  [[nodiscard]] int at(int u, int v) const { return map_.at_pixel(image_, color_, u, v); }
  /// The middle lines of a gate's bars, moved onto the evidence near by; where they were when that
  /// leads too far. @param bar  bar width / side of the middle lines.
  /// @param curves  how the lens bends them, in pixels.
  [[nodiscard]] Quad pulled(const Quad& bars_px, double bar, const SideCurves& curves = {}) const;

 private:
  Image image_;
  PictureColor color_;
  EvidenceMap map_;
};

}  // namespace gatefly
