// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/quad.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {
namespace {

using Polygon = FixedList<Eigen::Vector2d, 12>;

double polygon_area(const Polygon& p) {
  double twice = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) twice += cross(p[i], p[(i + 1) % p.size()]);
  return 0.5 * twice;
}

// Sutherland-Hodgman: what of `subject` lies on the inner side of the line a -> b.
Polygon clipped(const Polygon& subject, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  Polygon out;
  for (std::size_t i = 0; i < subject.size(); ++i) {
    const Eigen::Vector2d& p = subject[i];
    const Eigen::Vector2d& q = subject[(i + 1) % subject.size()];
    const double side_p = cross(b - a, p - a);
    const double side_q = cross(b - a, q - a);
    if (side_p >= 0) out.push_back(p);
    if ((side_p >= 0) != (side_q >= 0)) out.push_back(p + (q - p) * (side_p / (side_p - side_q)));
  }
  return out;
}

}  // namespace

double area(const Quad& quad) {
  double twice = 0.0;
  for (std::size_t i = 0; i < 4; ++i) twice += cross(quad[i], quad[(i + 1) % 4]);
  return 0.5 * twice;
}

double shared_area(const Quad& a, const Quad& b) {
  Quad window = b;
  if (area(window) < 0) std::swap(window[1], window[3]);
  Polygon shared;
  for (const auto& p : a) shared.push_back(p);
  for (std::size_t i = 0; i < 4; ++i) shared = clipped(shared, window[i], window[(i + 1) % 4]);
  return std::abs(polygon_area(shared));
}

bool overlaps(const Quad& a, const Quad& b, double part) {
  return shared_area(a, b) >= part * std::max(std::abs(area(a)), std::abs(area(b)));
}

bool stands_within(const Quad& small, const Quad& large) {
  // Part of the side within the widest bars' inner edges; nearly all of the area.
  constexpr double kOpening = 0.7, kAll = 0.98;
  const double area_of_small = std::abs(area(small));
  return area_of_small < kOpening * kOpening * std::abs(area(large)) &&
         shared_area(small, scaled(large, kOpening)) > kAll * area_of_small;
}

bool same_place(const Quad& a, const Quad& b) {
  return shared_area(a, b) > 0.5 * std::min(std::abs(area(a)), std::abs(area(b))) &&
         !stands_within(a, b) && !stands_within(b, a);
}

Quad clockwise_from_top_left(const Quad& quad) {
  Quad q = quad;
  if (area(q) < 0) std::swap(q[1], q[3]);
  std::size_t first = 0;
  for (std::size_t i = 1; i < 4; ++i)
    if (q[i].sum() < q[first].sum()) first = i;
  std::rotate(q.begin(), q.begin() + static_cast<std::ptrdiff_t>(first), q.end());
  return q;
}

Eigen::Vector2d center(const Quad& quad) { return 0.25 * (quad[0] + quad[1] + quad[2] + quad[3]); }

double largest_move(const Quad& a, const Quad& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < 4; ++i) most = std::max(most, (a[i] - b[i]).squaredNorm());
  return std::sqrt(most);
}

Quad scaled(const Quad& quad, double factor) {
  const Eigen::Vector2d middle = center(quad);
  Quad out;
  for (std::size_t i = 0; i < 4; ++i) out[i] = middle + factor * (quad[i] - middle);
  return out;
}

Quad to_cells(Quad quad_px, double cell) {
  for (auto& p : quad_px) p = to_cells(p, cell);
  return quad_px;
}

Quad to_pixels(Quad quad_cells, double cell) {
  for (auto& p : quad_cells) p = ((p.array() + 0.5) * cell - 0.5).matrix();
  return quad_cells;
}

}  // namespace gatefly
