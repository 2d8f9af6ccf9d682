// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/paper/paper_detector.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/detection/paper/color_mask.hpp"
#include "gatefly/detection/paper/snake.hpp"

namespace gatefly {
namespace {

int nearest(double x) { return static_cast<int>(std::floor(x + 0.5)); }

/// A bar's two ends, as far as its colour goes.
struct Stretch {
  Pixel from, to;
  [[nodiscard]] double length() const { return distance(from, to); }
};

Stretch vertical(const ColorMask& is_gate, Pixel p) {
  return {snake(is_gate, p, 0, -1), snake(is_gate, p, 0, +1)};
}

Stretch horizontal(const ColorMask& is_gate, Pixel p) {
  return {snake(is_gate, p, -1, 0), snake(is_gate, p, +1, 0)};
}

/// Upright square; centre in half pixels.
struct Square {
  int u_twice = 0, v_twice = 0, side = 0;

  bool operator==(const Square&) const = default;
  [[nodiscard]] Quad corners() const {
    const double u = 0.5 * u_twice, v = 0.5 * v_twice, h = 0.5 * side;
    return {{{u - h, v - h}, {u + h, v - h}, {u + h, v + h}, {u - h, v + h}}};
  }
};

/// As wide as the longer stretch, in the middle of the horizontal one and beside the middle of the
/// vertical one.
Square minimal_square(const Stretch& upright, const Stretch& level) {
  return {level.from.u + level.to.u, upright.from.v + upright.to.v,
          std::max(upright.to.v - upright.from.v, level.to.u - level.from.u)};
}

/// Choice among equally frequent values: the first, or the middle between first and last.
enum class Ties { kFirst, kMiddle };

/// The place in [from, to] where `count` is largest; `otherwise` where nothing is counted.
template <class Count>
double mode(int from, int to, Ties ties, double otherwise, const Count& count) {
  int most = 0;
  double first = otherwise, last = otherwise;
  for (int i = from; i <= to; ++i) {
    const int here = count(i);
    if (here > most)
      most = here, first = last = i;
    else if (here == most && most > 0)
      last = i;
  }
  return ties == Ties::kFirst ? first : 0.5 * (first + last);
}

/// Column and row with the most coloured pixels in the window around a corner.
Eigen::Vector2d refined(const ColorMask& is_gate, const Eigen::Vector2d& corner, double half_width,
                        Ties ties) {
  const int u0 = std::max(0, nearest(corner.x() - half_width)),
            v0 = std::max(0, nearest(corner.y() - half_width));
  const int u1 = std::min(is_gate.width() - 1, nearest(corner.x() + half_width));
  const int v1 = std::min(is_gate.height() - 1, nearest(corner.y() + half_width));
  const auto in_column = [&](int u) {
    int count = 0;
    for (int v = v0; v <= v1; ++v) count += is_gate(u, v);
    return count;
  };
  const auto in_row = [&](int v) {
    int count = 0;
    for (int u = u0; u <= u1; ++u) count += is_gate(u, v);
    return count;
  };
  return {mode(u0, u1, ties, corner.x(), in_column), mode(v0, v1, ties, corner.y(), in_row)};
}

Quad refined(const ColorMask& is_gate, Quad corners, double half_width, Ties ties) {
  for (Eigen::Vector2d& corner : corners) corner = refined(is_gate, corner, half_width, ties);
  return corners;
}

double side_length(const Quad& quad, std::size_t side) {
  return (quad[(side + 1) % 4] - quad[side]).norm();
}

bool every_side_exceeds(const Quad& quad, double length) {
  for (std::size_t side = 0; side < 4; ++side)
    if (side_length(quad, side) <= length) return false;
  return true;
}

/// Whether any pixel within 2 px is coloured: the mask dilated by a 5 x 5 square.
bool dilated(const ColorMask& is_gate, int u, int v) {
  if (is_gate(u, v)) return true;
  for (int dv = -2; dv <= 2; ++dv)
    for (int du = -2; du <= 2; ++du)
      if (is_gate(u + du, v + dv)) return true;
  return false;
}

/// Li18 Eq. (1) on an outline drawn 1 px wide, as far as it lies in the picture.
double polygon_fitness(const ColorMask& is_gate, const Quad& quad) {
  int colored = 0, count = 0;
  for (std::size_t side = 0; side < 4; ++side) {
    const Eigen::Vector2d from = quad[side], along = quad[(side + 1) % 4] - from;
    const int steps = std::max(1, nearest(along.cwiseAbs().maxCoeff()));
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector2d p = from + along * (static_cast<double>(i) / steps);
      const int u = nearest(p.x()), v = nearest(p.y());
      if (u < 0 || v < 0 || u >= is_gate.width() || v >= is_gate.height()) continue;
      colored += dilated(is_gate, u, v), ++count;
    }
  }
  return count > 0 ? static_cast<double>(colored) / count : 0.0;
}

/// The square around the gate that a coloured pixel belongs to, as far as the snakes can tell.
std::optional<Square> square_from(const ColorMask& is_gate, Pixel sample, double min_side_px) {
  const Stretch upright = vertical(is_gate, sample);
  if (upright.length() <= min_side_px) return std::nullopt;
  const Stretch lower = horizontal(is_gate, upright.to);
  if (lower.length() > min_side_px) return minimal_square(upright, lower);
  const Stretch upper = horizontal(is_gate, upright.from);
  if (upper.length() > min_side_px) return minimal_square(upright, upper);
  return std::nullopt;
}

/// As flown: both horizontal searches start in the sample's own column.
std::optional<Square> flown_square_from(const ColorMask& is_gate, Pixel sample,
                                        double min_side_px) {
  const Stretch upright = vertical(is_gate, sample);
  if (upright.length() <= min_side_px) return std::nullopt;
  for (const int v : {upright.to.v, upright.from.v}) {
    const Stretch level = horizontal(is_gate, {sample.u, v});
    if (level.length() > min_side_px) return minimal_square(upright, level);
  }
  return std::nullopt;
}

/// Evidence of 20 points on each side of a quad.
struct SideCheck {
  double fitness = 0.0;  ///< Coloured / all points inside the picture.
  int sides = 0;         ///< That are coloured and long enough.
};

SideCheck check_sides(const ColorMask& is_gate, const Quad& quad,
                      const FlownDetectorParams& params) {
  constexpr int kPoints = 20;
  SideCheck check;
  int colored_all = 0, inside_all = 0;
  for (std::size_t side = 0; side < 4; ++side) {
    int colored = 0;
    for (int i = 0; i < kPoints; ++i) {
      const double t = static_cast<double>(i) / kPoints;
      const Eigen::Vector2d p = (1 - t) * quad[side] + t * quad[(side + 1) % 4];
      const int u = nearest(p.x()), v = nearest(p.y());
      inside_all += u >= 0 && v >= 0 && u < is_gate.width() && v < is_gate.height();
      colored += is_gate(u, v);
    }
    colored_all += colored;
    check.sides += colored >= params.min_side_fitness * kPoints &&
                   side_length(quad, side) > params.min_side_px;
  }
  if (inside_all > 0) check.fitness = static_cast<double>(colored_all) / inside_all;
  return check;
}

/// Coloured part of 20 random points in the square's central half.
double random_inside(const ColorMask& is_gate, const Square& square, Rng& rng) {
  constexpr int kPoints = 20;
  int colored = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double u = 0.5 * square.u_twice + rng.uniform(-0.25, 0.25) * square.side;
    const double v = 0.5 * square.v_twice + rng.uniform(-0.25, 0.25) * square.side;
    colored += is_gate(nearest(u), nearest(v));
  }
  return static_cast<double>(colored) / kPoints;
}

/// Corners refined once; a gate when all four sides hold.
std::optional<GateDetection> flown_gate(const ColorMask& is_gate, const Quad& rough, double side,
                                        const FlownDetectorParams& params) {
  const Quad corners = refined(is_gate, rough, params.window * 0.5 * side, Ties::kMiddle);
  const SideCheck check = check_sides(is_gate, corners, params);
  if (check.sides < 4 || check.fitness <= params.min_fitness) return std::nullopt;
  return GateDetection{corners, check.fitness};
}

}  // namespace

PaperDetections detect_as_paper(const Image& image, const PaperDetectorParams& params, Rng& rng) {
  PaperDetections accepted;
  // the same square has the same answer: no need to refine it again
  FixedList<Square, 1'000> tried;
  const ColorMask is_gate{image, params.color};
  for (int sample = 0; sample < params.samples && !accepted.full(); ++sample) {
    const Pixel P0{rng.uniform_index(image.width()), rng.uniform_index(image.height())};
    if (!is_gate(P0.u, P0.v)) continue;
    const auto square = square_from(is_gate, P0, params.min_side_px);
    if (!square || std::find(tried.begin(), tried.end(), *square) != tried.end()) continue;
    tried.push_back(*square);

    const double half = 0.5 * square->side;
    const Quad once = refined(is_gate, square->corners(), params.first_window * half, Ties::kFirst);
    const Quad corners = refined(is_gate, once, params.second_window * half, Ties::kFirst);
    if (!every_side_exceeds(corners, params.min_side_px)) continue;
    const GateDetection gate{corners, polygon_fitness(is_gate, corners)};
    const bool known =
        std::any_of(accepted.begin(), accepted.end(), [&](const GateDetection& other) {
          return overlaps(gate.corners_px, other.corners_px, params.same_gate);
        });
    if (gate.fitness > params.min_color_fitness && !known) accepted.push_back(gate);
  }
  return accepted;
}

std::optional<GateDetection> detect_as_flown(const Image& image, const FlownDetectorParams& params,
                                             Rng& rng, const std::optional<Quad>& previous) {
  if (image.empty()) return std::nullopt;
  const ColorMask is_gate{image, params.color};
  FixedList<Square, 50> improving;  // each has a better fitness than the one before
  double best_square = 0.0;
  for (int sample = 0; sample < params.samples && !improving.full(); ++sample) {
    const Pixel P0{rng.uniform_index(image.width()), rng.uniform_index(image.height())};
    if (!is_gate(P0.u, P0.v)) continue;
    const auto square = flown_square_from(is_gate, P0, params.min_side_px);
    if (!square) continue;
    const double fitness = check_sides(is_gate, square->corners(), params).fitness;
    if (fitness <= best_square || random_inside(is_gate, *square, rng) > params.max_inside)
      continue;
    best_square = fitness;
    improving.push_back(*square);
  }

  std::optional<GateDetection> best;
  constexpr std::size_t kRefined = 10;
  for (std::size_t i = improving.size() - std::min(improving.size(), kRefined);
       i < improving.size(); ++i) {
    const auto gate = flown_gate(is_gate, improving[i].corners(), improving[i].side, params);
    if (gate && (!best || gate->fitness > best->fitness)) best = gate;
  }
  if (best || !previous) return best;
  return flown_gate(is_gate, *previous, side_length(*previous, 0), params);
}

}  // namespace gatefly
