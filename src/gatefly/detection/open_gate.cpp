// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/open_gate.hpp"

#include <algorithm>

#include "gatefly/detection/color_mask.hpp"
#include "gatefly/detection/outline.hpp"
#include "gatefly/detection/snake.hpp"

namespace gatefly {
namespace {

constexpr int kBorder = 2;  // a bar that ends this near to the border goes on beyond it [px]
// Snakes of one saturation level are followed over so many widths and heights together: a wall of the gate's colour
// would cost 36 times what other pictures do. [20 and no limit: the same 22 gates in basement580 and a rendered lap]
constexpr int kMostFollowed = 20;

Eigen::Vector2d vector_of(Pixel p) { return {p.u, p.v}; }

std::optional<OpenGate> checked(const ColorMask& is_gate, const Quad& rough, const OpenGateParams& params) {
  if (inside_fraction(is_gate, rough) > params.max_inside) return std::nullopt;  // cheap, and ends most walls and combs
  const Quad lines = corners_by_lines(is_gate, rough);
  const Eigen::Vector2d along = lines[2] - lines[3];  // bottom, left to right
  const double width = along.norm();
  const double left = (lines[3] - lines[0]).norm(), right = (lines[2] - lines[1]).norm();
  if (width < params.min_width_px || std::min(left, right) < 0.35 * width || std::max(left, right) > 1.2 * width)
    return std::nullopt;
  const OutlineFitness fitness = outline_fitness(is_gate, lines);
  const double weakest = std::min({fitness.side[1], fitness.side[2], fitness.side[3]});
  if (weakest < 0.7 || inside_fraction(is_gate, lines) > params.max_inside) return std::nullopt;
  for (const auto& corner : {lines[2], lines[3]})
    if (corner.x() < 1 || corner.x() > is_gate.width() - 2 || corner.y() > is_gate.height() - 2) return std::nullopt;
  // From the centre lines out to the corners of the frame.
  const double out = 0.5 * params.bar_ratio / (1.0 - params.bar_ratio);
  const Eigen::Vector2d sideways = out * along, down{-sideways.y(), sideways.x()};
  return OpenGate{lines[3] - sideways + down, lines[2] + sideways + down,
                  (fitness.side[1] + fitness.side[2] + fitness.side[3]) / 3.0};
}

std::optional<OpenGate> search(const ColorMask& is_gate, const OpenGateParams& params, Rng& rng) {
  std::optional<OpenGate> best;
  int checks_left = 8;
  double left_to_follow = kMostFollowed * (is_gate.width() + is_gate.height());
  const auto follow = [&](Pixel from, int dv) {
    const Pixel end = snake(is_gate, from, 0, dv);
    left_to_follow -= distance(from, end);
    return end;
  };
  for (int sample = 0; sample < params.max_samples && checks_left > 0 && left_to_follow > 0.0; ++sample) {
    const Pixel P0{rng.uniform_index(is_gate.width()), rng.uniform_index(is_gate.height())};
    if (!is_gate(P0.u, P0.v)) continue;
    const Pixel top = follow(P0, -1);
    if (top.v > kBorder) continue;
    const Pixel foot = follow(P0, +1);
    const Pixel other_foot = search_horizontal(is_gate, foot);
    left_to_follow -= distance(foot, other_foot);
    if (distance(foot, other_foot) < params.min_width_px) continue;
    const Pixel other_top = follow(other_foot, -1);
    if (other_top.v > kBorder) continue;
    --checks_left;
    const bool on_the_left = foot.u < other_foot.u;
    const Quad rough{vector_of(on_the_left ? top : other_top), vector_of(on_the_left ? other_top : top),
                     vector_of(on_the_left ? other_foot : foot), vector_of(on_the_left ? foot : other_foot)};
    const auto gate = checked(is_gate, rough, params);
    if (gate && (!best || gate->fitness > best->fitness)) best = gate;
    if (best && best->fitness > params.sure_fitness) break;
  }
  return best;
}

}  // namespace

std::optional<OpenGate> detect_open_gate(const Image& image, const ColorRange& color,
                                         const OpenGateParams& params, Rng& rng) {
  if (image.empty()) return std::nullopt;
  for (const int level : params.chroma_levels) {
    ColorRange range = color;
    range.min_chroma = std::max(color.min_chroma, level);
    if (const auto gate = search(ColorMask{image, range}, params, rng)) return gate;
    if (level <= color.min_chroma) break;
  }
  return std::nullopt;
}

}  // namespace gatefly
