// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/annotate.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "gatefly/files/text.hpp"

namespace gatefly::drawing {
namespace {

constexpr int kLargestSide = 1600;  // [px]
constexpr double kLargestScale = 3.0;

/// Light letters on a dark plate, wholly inside the picture: readable on any background.
void draw_label(Canvas& canvas, const std::string& label, const Eigen::Vector2d& above,
                const Color& color) {
  const Lettering lettering{.color = kDark.page, .size = 13.0, .bold = true};
  Box plate{.x = above.x(),
            .y = above.y() - 26.0,
            .width = canvas.text_width(label, lettering) + 12.0,
            .height = 19.0};
  plate.x = std::clamp(plate.x, 2.0, std::max(2.0, canvas.width() - plate.width - 2.0));
  plate.y = std::clamp(plate.y, 2.0, std::max(2.0, canvas.height() - plate.height - 2.0));
  canvas.fill(plate, color, 4.0);
  canvas.text({plate.x + 6.0, plate.y + 14.0}, label, lettering);
}

std::string label_of(std::size_t rank, const GateDetection& gate) {
  return (gate.method == DetectionMethod::kBars ? "part " : "gate ") + std::to_string(rank) +
         "   " + files::fixed(gate.fitness, 2);
}

}  // namespace

double annotation_scale(const Image& image) {
  const double fits =
      static_cast<double>(kLargestSide) / std::max({image.width(), image.height(), 1});
  return fits < 1.0 ? fits : std::min(std::floor(fits), kLargestScale);
}

void draw_detection(Canvas& canvas, const GateDetection& gate, const Eigen::Vector2d& at,
                    double scale, const Stroke& stroke) {
  Quad corners;
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = at + scale * (gate.corners_px[i] + Eigen::Vector2d{0.5, 0.5});
  const bool is_part = gate.method == DetectionMethod::kBars;
  const auto in_view = [&](std::size_t i) { return !is_part || gate.corner_fitness[i] > 0.0; };
  for (const Stroke& each :
       {Stroke{.color = kDark.page.faded(0.6), .width = stroke.width + 2.0}, stroke}) {
    if (!is_part) canvas.outline(corners, each);
    // A part shows its side bars, and the level ones as far as they are known.
    if (is_part)
      canvas.line(corners[0], corners[3], each), canvas.line(corners[1], corners[2], each);
    if (is_part && (in_view(0) || in_view(1))) canvas.line(corners[0], corners[1], each);
    if (is_part && (in_view(2) || in_view(3))) canvas.line(corners[2], corners[3], each);
  }
  // Rings, so that the corner itself stays in sight.
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!in_view(i)) continue;
    canvas.circle(corners[i], 2.5 * stroke.width,
                  {.color = kDark.page.faded(0.6), .width = stroke.width + 1.5});
    canvas.circle(corners[i], 2.5 * stroke.width, stroke);
  }
  if (in_view(0)) canvas.disc(corners[0], 1.2 * stroke.width, stroke.color);
}

Canvas annotated(const Image& image, std::span<const GateDetection> gates) {
  if (image.empty()) throw std::runtime_error("the picture is empty");
  const double scale = annotation_scale(image);
  const auto enlarged = [scale](int side) {
    return std::max(1, static_cast<int>(std::lround(scale * side)));
  };
  Canvas canvas(enlarged(image.width()), enlarged(image.height()));
  canvas.image(image, {0, 0}, scale);

  // The best last, on top of the others.
  for (std::size_t rank = gates.size(); rank-- > 0;) {
    const GateDetection& gate = gates[rank];
    const Color color = kDark.found.faded(rank == 0 ? 1.0 : 0.75);
    draw_detection(canvas, gate, {0, 0}, scale, {.color = color, .width = rank == 0 ? 2.0 : 1.2});
    const Eigen::Vector2d top_left = scale * gate.corners_px[0].cwiseMin(gate.corners_px[1]);
    draw_label(canvas, label_of(rank, gate), top_left, color);
  }
  if (gates.empty()) draw_label(canvas, "no gate", {8.0, canvas.height() - 1.0}, kDark.muted);
  return canvas;
}

}  // namespace gatefly::drawing
