// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/outline.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {
namespace {

int nearest(double x) { return static_cast<int>(std::floor(x + 0.5)); }

struct Line {
  Eigen::Vector2d point, direction;
};

// Total least squares, then once more without what lies off by more than twice the median.
std::optional<Line> fitted_line(FixedList<Eigen::Vector2d, 16> points) {
  for (int pass = 0; pass < 2; ++pass) {
    if (points.size() < 4) return std::nullopt;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const auto& p : points) mean += p;
    mean /= static_cast<double>(points.size());
    double xx = 0, xy = 0, yy = 0;
    for (const auto& p : points) {
      const Eigen::Vector2d d = p - mean;
      xx += d.x() * d.x(), xy += d.x() * d.y(), yy += d.y() * d.y();
    }
    // Direction of the larger eigenvalue of [[xx, xy], [xy, yy]].
    const double half = 0.5 * (xx - yy);
    const double root = std::sqrt(half * half + xy * xy);
    Eigen::Vector2d direction = half > 0 ? Eigen::Vector2d{half + root, xy} : Eigen::Vector2d{xy, root - half};
    if (direction.squaredNorm() < 1e-12) return std::nullopt;
    direction.normalize();
    if (pass == 1) return Line{mean, direction};

    const auto off = [&](const Eigen::Vector2d& p) {
      return std::abs(direction.x() * (p - mean).y() - direction.y() * (p - mean).x());
    };
    std::array<double, 16> sorted{};
    for (std::size_t i = 0; i < points.size(); ++i) sorted[i] = off(points[i]);
    std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(points.size()));
    const double limit = std::max(0.75, 2.0 * sorted[points.size() / 2]);
    FixedList<Eigen::Vector2d, 16> kept;
    for (const auto& p : points)
      if (off(p) <= limit) kept.push_back(p);
    points = kept;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> intersection(const Line& a, const Line& b) {
  const double det = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
  if (std::abs(det) < 0.2) return std::nullopt;  // less than 12° apart: no corner
  const Eigen::Vector2d d = b.point - a.point;
  const double along = (d.x() * b.direction.y() - d.y() * b.direction.x()) / det;
  return Eigen::Vector2d{a.point + along * a.direction};
}

// Middle of the coloured run that crosses the centre line at `on_line`: where blur and threshold cancel.
std::optional<Eigen::Vector2d> run_middle(const ColorMask& is_gate, const Eigen::Vector2d& on_line,
                                          const Eigen::Vector2d& across, double reach) {
  const auto colored = [&](double step) {
    const Eigen::Vector2d p = on_line + step * across;
    return is_gate(nearest(p.x()), nearest(p.y()));
  };
  // Enter the run at the line, or up to 2 px beside it.
  double inside = 0.0;
  bool found = false;
  for (const double offset : {0.0, -1.0, 1.0, -2.0, 2.0})
    if (colored(offset)) {
      inside = offset, found = true;
      break;
    }
  if (!found) return std::nullopt;
  double high = inside, low = inside;
  while (high - inside < reach && colored(high + 0.5)) high += 0.5;
  while (inside - low < reach && colored(low - 0.5)) low -= 0.5;
  if (high - inside >= reach || inside - low >= reach) return std::nullopt;  // runs into something else
  return on_line + 0.5 * (high + low) * across;
}

}  // namespace

OutlineFitness outline_fitness(const ColorMask& is_gate, const Quad& quad) {
  OutlineFitness fitness;
  int colored_all = 0, count_all = 0;
  for (std::size_t side = 0; side < 4; ++side) {
    const Eigen::Vector2d& from = quad[side];
    const Eigen::Vector2d along = quad[(side + 1) % 4] - from;
    const int steps = std::clamp(nearest(along.norm()), 1, 640);
    int colored = 0;
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector2d p = from + along * ((i + 0.5) / steps);
      colored += is_gate.near(nearest(p.x()), nearest(p.y()));
    }
    fitness.side[side] = static_cast<double>(colored) / steps;
    colored_all += colored, count_all += steps;
  }
  fitness.all = static_cast<double>(colored_all) / count_all;  // Eq. (1)
  return fitness;
}

double inside_fraction(const ColorMask& is_gate, const Quad& quad) {
  // A 6 x 6 grid over the central half, instead of the flight code's 20 random points.
  constexpr int kGrid = 6;
  int colored = 0;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j) {
      const double s = 0.25 + 0.5 * (i + 0.5) / kGrid, t = 0.25 + 0.5 * (j + 0.5) / kGrid;
      const Eigen::Vector2d p = (1 - t) * ((1 - s) * quad[0] + s * quad[1]) +
                                t * ((1 - s) * quad[3] + s * quad[2]);
      colored += is_gate(nearest(p.x()), nearest(p.y()));
    }
  return static_cast<double>(colored) / (kGrid * kGrid);
}

Quad corners_by_lines(const ColorMask& is_gate, const Quad& rough) {
  constexpr int kScans = 12;
  // Two lines a side, one for each half: fisheye bars are bent.
  std::array<std::array<std::optional<Line>, 2>, 4> lines;
  for (std::size_t side = 0; side < 4; ++side) {
    const Eigen::Vector2d& from = rough[side];
    const Eigen::Vector2d along = rough[(side + 1) % 4] - from;
    const double length = along.norm();
    if (length < 4.0) continue;
    const Eigen::Vector2d across{-along.y() / length, along.x() / length};
    for (std::size_t half = 0; half < 2; ++half) {
      FixedList<Eigen::Vector2d, 16> points;
      for (int i = 0; i < kScans; ++i) {
        // From just beside the corner to a little past the middle.
        const double t = 0.07 + 0.53 * (i + 0.5) / kScans;
        const Eigen::Vector2d on_line = from + along * (half == 0 ? t : 1.0 - t);
        if (const auto middle = run_middle(is_gate, on_line, across, 3.0 + 0.12 * length)) points.push_back(*middle);
      }
      lines[side][half] = fitted_line(points);
    }
  }
  Quad corners = rough;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& before = lines[(i + 3) % 4][1];
    const auto& after = lines[i][0];
    if (!before || !after) continue;
    const auto corner = intersection(*before, *after);
    const double size = (rough[(i + 1) % 4] - rough[i]).norm();
    if (corner && (*corner - rough[i]).norm() < 3.0 + 0.15 * size) corners[i] = *corner;
  }
  return corners;
}

Quad scaled(const Quad& quad, double factor) {
  const Eigen::Vector2d middle = center(quad);
  Quad out;
  for (std::size_t i = 0; i < 4; ++i) out[i] = middle + factor * (quad[i] - middle);
  return out;
}

}  // namespace gatefly
