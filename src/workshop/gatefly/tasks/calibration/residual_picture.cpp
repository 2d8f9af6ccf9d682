// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/residual_picture.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gatefly/files/text.hpp"

namespace gatefly::calibration {

drawing::Canvas residual_picture(const Calibration& answer) {
  constexpr double kWidth = 1200.0, kBorder = 24.0, kHead = 56.0;
  constexpr double kRmsLength = 12.0;  // of an arrow as long as the RMS [px of the drawing]
  const ModelResult& best = answer.best();
  const double scale = kWidth / answer.size_px.x(), height = scale * answer.size_px.y();
  const double enlarged =
      best.rms_px > 0.0 ? std::pow(10.0, std::floor(std::log10(kRmsLength / best.rms_px))) : 1.0;
  const double stretch = enlarged * std::max(1.0, std::floor(kRmsLength / best.rms_px / enlarged));

  drawing::Canvas canvas(static_cast<int>(kWidth + 2 * kBorder),
                         static_cast<int>(height + kHead + kBorder));
  canvas.text({kBorder, 34.0},
              name_of(best.fit.model) + ": residuals of " + std::to_string(answer.kept.size()) +
                  " pictures, RMS " + files::text_of(best.rms_px, 3) + " px; arrows are " +
                  files::text_of(stretch) + " times as long",
              {.color = drawing::kLight.ink, .size = 18.0});
  const drawing::Box frame{kBorder, kHead, kWidth, height};
  canvas.fill(frame, drawing::kLight.panel);
  canvas.clip(frame);
  const Eigen::Vector2d origin{kBorder, kHead};
  const AnyCamera lens = best.fit.lens();
  for (std::size_t i = 0; i < answer.kept.size(); ++i) {
    const BoardView& view = answer.kept[i];
    const auto residuals = residuals_px(view, lens, best.fit.poses[i]);
    for (std::size_t j = 0; j < residuals.size(); ++j) {
      if (!residuals[j].allFinite()) continue;
      const Eigen::Vector2d at =
          origin + scale * (view.corners[j].px + Eigen::Vector2d::Constant(0.5));
      canvas.disc(at, 1.2, drawing::kLight.muted);
      canvas.line(at, at + stretch * residuals[j], {.color = drawing::kLight.found, .width = 1.2});
    }
  }
  canvas.unclip();
  return canvas;
}

}  // namespace gatefly::calibration
