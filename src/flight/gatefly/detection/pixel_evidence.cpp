// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/pixel_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/detection/search/frame_fit.hpp"

namespace gatefly {

void PixelEvidence::read(const Image& image, const ColorModel& color) {
  image_ = image;
  color_.set(color, tone_of(image, color));
  map_.fill(image, color_);
}

Quad PixelEvidence::pulled(const Quad& bars_px, double bar, const SideCurves& curves) const {
  constexpr double kLeastSide = 5.0, kMostAspect = 6.0;
  const auto has_shape = [](const Quad& q) { return is_frame_shaped(q, kLeastSide, kMostAspect); };
  const double size = std::sqrt(std::abs(area(bars_px)));
  const auto evidence = [this](int u, int v) { return at(u, v); };
  FrameFit<decltype(evidence)> fit{evidence, {}, bar};
  fit.set_least_offset(3.0);
  fit.set_curves(curves);
  Quad q = bars_px;
  double score = fit.score(q).total;
  for (const int reach : {4, 3, 2, 1}) {
    const auto moved = fit.moved(q, reach);
    if (!moved || !has_shape(*moved)) break;
    if (const double now = fit.score(*moved).total; now > score) q = *moved, score = now;
  }
  const int around = static_cast<int>((0.5 * bar + 0.044) * std::sqrt(std::abs(area(q))) + 0.5);
  const auto centered = fit.centered(q, std::clamp(around, 2, 5));
  if (centered && has_shape(*centered) && fit.score(*centered).total > score - 0.3) q = *centered;
  return largest_move(q, bars_px) < std::max(8.0, 0.12 * size) ? q : bars_px;
}

}  // namespace gatefly
