// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/snake_gate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "gatefly/detection/color_mask.hpp"
#include "gatefly/detection/outline.hpp"
#include "gatefly/detection/snake.hpp"

namespace gatefly {
namespace {

Eigen::Vector2d vector_of(Pixel p) { return {p.u, p.v}; }

// The upright square around the stretches found: as wide as the longer one.
Quad minimal_square(Pixel P1, Pixel P2, Pixel from, Pixel to) {
  const double height = P2.v - P1.v;
  const double half = 0.5 * std::max(height, std::abs(static_cast<double>(to.u - from.u)));
  const double u = 0.5 * (from.u + to.u), v = 0.5 * (P1.v + P2.v);
  return {{{u - half, v - half}, {u + half, v - half}, {u + half, v + half}, {u - half, v + half}}};
}

bool is_convex(const Quad& q) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = q[(i + 1) % 4] - q[i], b = q[(i + 2) % 4] - q[(i + 1) % 4];
    if (a.x() * b.y() - a.y() * b.x() <= 0) return false;
  }
  return true;
}

bool has_gate_shape(const Quad& q, const SnakeGateParams& params) {
  double longest = 0, shortest = 1e9;
  for (std::size_t i = 0; i < 4; ++i) {
    const double length = (q[(i + 1) % 4] - q[i]).norm();
    longest = std::max(longest, length), shortest = std::min(shortest, length);
  }
  return shortest > params.min_side_px * 0.8 && longest < params.max_aspect * shortest && is_convex(q);
}

// Refinement and the second check: shape, four sides, empty inside, fitness.
std::optional<GateDetection> checked(const ColorMask& is_gate, const Quad& rough,
                                     const SnakeGateParams& params) {
  // Twice: the first pass may start half a window away.
  const Quad lines = corners_by_histogram(
      is_gate, corners_by_histogram(is_gate, rough, params.window), 0.5 * params.window);
  if (!has_gate_shape(lines, params)) return std::nullopt;
  const OutlineFitness fitness = outline_fitness(is_gate, lines);
  if (fitness.all <= params.min_color_fitness) return std::nullopt;
  for (const double side : fitness.side)
    if (side < params.min_side_fitness) return std::nullopt;
  if (inside_fraction(is_gate, lines) > params.max_inside) return std::nullopt;
  // Cut off by the border it is not this gate that was measured.
  const Quad bars = corners_by_lines(is_gate, lines);
  for (const auto& p : bars)
    if (!(p.x() >= 1.0 && p.y() >= 1.0 && p.x() <= is_gate.width() - 2.0 && p.y() <= is_gate.height() - 2.0))
      return std::nullopt;
  // From the bars' centre lines out to the frame's outer corners: the ratio is known, the blur is not.
  const Quad outer = scaled(bars, 1.0 / (1.0 - params.bar_ratio));
  return GateDetection{clockwise_from_top_left(outer), fitness.all};
}

bool same_gate(const GateDetection& a, const GateDetection& b) {
  const double shared = shared_area(a.corners_px, b.corners_px);
  const double smaller = std::min(std::abs(area(a.corners_px)), std::abs(area(b.corners_px)));
  return shared > 0.5 * smaller;
}

// Keeps the list sorted by fitness, one entry a gate.
void insert(GateDetections& found, const GateDetection& gate) {
  for (auto& other : found)
    if (same_gate(other, gate)) {
      if (gate.color_fitness > other.color_fitness) other = gate;
      return;
    }
  if (!found.push_back(gate) && found.back().color_fitness < gate.color_fitness) found.back() = gate;
}

void sort_best_first(GateDetections& found) {
  std::sort(found.begin(), found.end(), [](const GateDetection& a, const GateDetection& b) {
    return a.color_fitness > b.color_fitness;
  });
}

// Already on the outline of a gate that was found: nothing new can come from there.
bool explained(const GateDetections& found, Pixel p) {
  for (const auto& gate : found)
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d a = gate.corners_px[i], d = gate.corners_px[(i + 1) % 4] - a;
      const double t = std::clamp((vector_of(p) - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
      if ((vector_of(p) - a - t * d).squaredNorm() < 25.0 && gate.color_fitness > 0.9) return true;
    }
  return false;
}

}  // namespace

namespace {

// A picture full of the colour must not cost more than one with a gate. [ours: these see all real ones]
struct Budget {
  int snakes = 500, checks = 60;
};

// One pass of Algorithm 1 over the picture at one saturation level.
void search(const ColorMask& is_gate, const SnakeGateParams& params, Rng& rng, GateDetections& found, Budget& left) {
  int snakes_left = std::min(150, left.snakes), checks_left = std::min(30, left.checks);
  left.snakes -= snakes_left, left.checks -= checks_left;
  const auto try_quad = [&](const Quad& rough) {
    if (checks_left-- <= 0) return;
    if (const auto gate = checked(is_gate, rough, params)) insert(found, *gate);
  };
  for (int sample = 0; sample < params.max_samples && snakes_left > 0 && checks_left > 0; ++sample) {
    const Pixel P0{rng.uniform_index(is_gate.width()), rng.uniform_index(is_gate.height())};
    if (!is_gate(P0.u, P0.v) || explained(found, P0)) continue;
    --snakes_left;

    // Algorithm 2: climb and descend one bar, then follow the others sideways from both ends.
    const Pixel P1 = snake(is_gate, P0, 0, -1);
    const Pixel P2 = snake(is_gate, P0, 0, +1);
    if (distance(P1, P2) <= params.min_side_px) continue;
    const Pixel P3 = search_horizontal(is_gate, P1);
    const Pixel P4 = search_horizontal(is_gate, P2);
    const bool top = distance(P1, P3) > params.min_side_px;
    const bool bottom = distance(P2, P4) > params.min_side_px;

    if (bottom) try_quad(minimal_square(P1, P2, P2, P4));
    if (top) try_quad(minimal_square(P1, P2, P1, P3));
    if (top && bottom)
      try_quad(clockwise_from_top_left({vector_of(P1), vector_of(P3), vector_of(P4), vector_of(P2)}));
  }
  left.snakes += std::max(0, snakes_left), left.checks += std::max(0, checks_left);
}

}  // namespace

GateDetections detect_gates(const Image& image, const ColorRange& color,
                            const SnakeGateParams& params, Rng& rng) {
  GateDetections found;
  if (image.empty()) return found;
  Budget budget;
  for (const int level : params.chroma_levels) {
    ColorRange range = color;
    range.min_chroma = std::max(color.min_chroma, level);
    search(ColorMask{image, range}, params, rng, found, budget);
    sort_best_first(found);
    if (!found.empty() && found[0].color_fitness >= params.sure_fitness) break;
    if (level <= color.min_chroma) break;
  }
  return found;
}

GateDetections detect_gates_near(const Image& image, const ColorRange& color,
                                 const SnakeGateParams& params, const Quad& previous) {
  GateDetections found;
  if (image.empty()) return found;
  for (const int level : params.chroma_levels) {
    ColorRange range = color;
    range.min_chroma = std::max(color.min_chroma, level);
    if (const auto gate = checked(ColorMask{image, range}, previous, params)) insert(found, *gate);
    if (!found.empty() || level <= color.min_chroma) break;
  }
  return found;
}

}  // namespace gatefly
