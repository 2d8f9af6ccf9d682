// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/path.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

constexpr double kShortestRamp = 0.1;  // [m]

}  // namespace

PathPoint point_on(const Segment& segment, double s) {
  const auto [sin0, cos0] = sincos(segment.heading);
  if (segment.curvature == 0.0)
    return {segment.start + s * Eigen::Vector2d{cos0, sin0}, segment.heading, 0.0};
  const double heading = segment.heading + segment.curvature * s;
  const auto [sin1, cos1] = sincos(heading);
  const Eigen::Vector2d chord{(sin1 - sin0) / segment.curvature, (cos0 - cos1) / segment.curvature};
  return {segment.start + chord, wrap_angle(heading), segment.curvature};
}

double Path::length() const {
  double total = 0.0;
  for (const auto& segment : segments) total += segment.length;
  return total;
}

PathPoint Path::at(double s) const {
  if (segments.empty()) return {};
  if (s < 0.0) {
    Segment back = segments[0];
    back.curvature = 0.0;
    return point_on(back, s);
  }
  for (const auto& segment : segments) {
    if (s <= segment.length) return point_on(segment, s);
    s -= segment.length;
  }
  PathPoint end = point_on(segments.back(), segments.back().length);
  const auto [sine, cosine] = sincos(end.heading);
  return {end.position + s * Eigen::Vector2d{cosine, sine}, end.heading, 0.0};
}

double Path::nearest(const Eigen::Vector2d& position, double from, double to) const {
  // Coarse, then fine: paths are metres long and curve gently against the steps.
  const auto distance2 = [&](double s) { return (at(s).position - position).squaredNorm(); };
  double best = from, least = distance2(best);
  for (double step = 0.10, low = from, high = to; step > 1e-3; step *= 0.1) {
    for (double s = low; s <= high; s += step)
      if (const double d = distance2(s); d < least) best = s, least = d;
    low = std::max(from, best - step), high = std::min(to, best + step);
  }
  return best;
}

PathHeight Path::height_at(double s) const {
  if (levels.empty()) return {};
  std::size_t next = 0;
  while (next + 1 < levels.size() && levels[next].s <= s) ++next;
  const Level &from = levels[next > 0 ? next - 1 : 0], &to = levels[next];
  const double length = std::max(to.s - from.s, kShortestRamp);
  const double t = std::clamp((s - from.s) / length, 0.0, 1.0), rise = to.z - from.z;
  return {from.z + rise * t * t * (3.0 - 2.0 * t), 6.0 * rise * t * (1.0 - t) / length};
}

void Path::climb(double z_from, double z_to) {
  const double total = length();
  levels.clear();
  (void)levels.push_back({0.0, z_from});
  (void)levels.push_back({std::max(0.5 * total, total - 1.5), z_to});
}

}  // namespace gatefly
