// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

constexpr double kShortestRamp = 0.1;  // [m]

Segment straight_from(const Eigen::Vector2d& start, double heading) {
  return {.start = start, .heading = heading};
}

/// Metres along a segment, or what it would be if it went on, to where `position` is abeam; of a circle the place within half a turn
/// of `middle`.
double nearest_on(const Segment& segment, const Eigen::Vector2d& position, double middle) {
  const auto [sine, cosine] = sincos(segment.heading);
  const Eigen::Vector2d from_start = position - segment.start;
  if (segment.curvature == 0.0) return from_start.dot(Eigen::Vector2d{cosine, sine});
  const Eigen::Vector2d from_center =
      from_start - Eigen::Vector2d{-sine, cosine} / segment.curvature;
  const double heading =
      atan2(segment.curvature * from_center.x(), -segment.curvature * from_center.y());
  return middle +
         wrap_angle(heading - segment.heading - segment.curvature * middle) / segment.curvature;
}

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
  double best = from, least = std::numeric_limits<double>::infinity(), begins = 0.0;
  // Compares the part of a segment, which begins `begins` metres along, that lies within [from, to].
  const auto look_at = [&](const Segment& segment, double low, double high) {
    low = std::max(low, from - begins), high = std::min(high, to - begins);
    if (low > high) return;
    const double s = std::clamp(nearest_on(segment, position, 0.5 * (low + high)), low, high);
    const double distance2 = (point_on(segment, s).position - position).squaredNorm();
    if (distance2 < least) best = begins + s, least = distance2;
  };
  if (segments.empty()) return best;
  look_at(straight_from(segments[0].start, segments[0].heading), from, 0.0);
  for (const Segment& segment : segments) {
    look_at(segment, 0.0, segment.length);
    begins += segment.length;
  }
  if (to <= begins) return best;
  const PathPoint end = point_on(segments.back(), segments.back().length);
  look_at(straight_from(end.position, end.heading), 0.0, to - begins);
  return best;
}

PathHeight Path::height_at(double s) const {
  if (levels.empty()) return {};
  std::size_t next = 0;
  // At most once a level.
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
