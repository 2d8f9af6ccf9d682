// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/frame_fit.hpp"

namespace gatefly {

/// A frame moved onto the evidence, side by side, as long as it helps. Lengths in cells.
template <class Fit>
[[nodiscard]] Frame pulled(const Fit& fit, Frame f, double least_side, double most_aspect) {
  // Only a large frame needs so many cells: all pairs of ends are tried.
  constexpr double kLarge = 64.0;
  const double size = std::sqrt(std::abs(area(f.quad)));
  const int most = size > kLarge ? 10 : 5;
  for (const double part : {0.16, 0.12, 0.08}) {
    const auto moved = fit.moved(f.quad, std::clamp(static_cast<int>(part * size + 0.5), 1, most));
    if (!moved || !is_frame_shaped(*moved, least_side, most_aspect)) break;
    const FrameScore now = fit.score(*moved);
    if (now.total <= f.score.total) break;
    f = {*moved, now};
  }
  return f;
}

/// The same on pixels, and through the middle of the bars.
template <class Fit>
[[nodiscard]] Frame finished(const Fit& fit, Quad q, double least_side,
                             const GateDetectorParams& params) {
  const auto has_shape = [&](const std::optional<Quad>& quad) {
    return quad && is_frame_shaped(*quad, least_side, params.max_aspect);
  };
  FrameScore score = fit.score(q);
  for (const int reach : {3, 2, 1}) {
    const auto moved = fit.moved(q, reach);
    if (!has_shape(moved)) break;
    const FrameScore now = fit.score(*moved);
    if (now.total > score.total) q = *moved, score = now;
  }
  const double size = std::sqrt(std::abs(area(q)));
  const double around = std::min(0.0437 * size, 5.0);
  const auto centered =
      fit.centered(q, std::max(2, static_cast<int>(0.5 * params.bar() * size + around + 0.5)));
  if (has_shape(centered)) {
    const FrameScore now = fit.score(*centered);
    // sub-pixel is worth a little evidence
    if (now.total > score.total - 0.3) q = *centered, score = now;
  }
  return {q, score};
}

}  // namespace gatefly
