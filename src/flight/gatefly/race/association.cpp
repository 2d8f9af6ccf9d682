// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/association.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

namespace gatefly {
namespace {

using eskf::Feature;
using eskf::GateSight;

struct Point {
  Feature::Kind kind;
  std::uint8_t which;
  Eigen::Vector2d px;
};

std::optional<GateSight> sight_of(std::span<const Point> points, GateSight::Quality quality,
                                  const PictureClock& picture) {
  GateSight sight;
  sight.quality = quality;
  sight.jitter = picture.jitter;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Point& point : points) middle += point.px / static_cast<double>(points.size());
  const auto later = [&](const Eigen::Vector2d& px) {
    return picture.timing.later(px, picture.size_px);
  };
  sight.time = picture.arrival - picture.timing.latency + later(middle);
  for (const Point& point : points) {
    const auto bearing = picture.camera.lens.bearing(point.px);
    if (!bearing) return std::nullopt;
    (void)sight.features.push_back({.kind = point.kind,
                                    .which = point.which,
                                    .late = later(point.px) - later(middle),
                                    .bearing_C = *bearing,
                                    .from_middle_px = point.px - middle});
  }
  return sight;
}

}  // namespace

std::optional<GateSight> sight_of(const Quad& corners_px, const PictureClock& picture) {
  std::array<Point, 4> points;
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {Feature::Kind::kCorner, static_cast<std::uint8_t>(i), corners_px[i]};
  return sight_of(points, GateSight::Quality::kWhole, picture);
}

std::optional<GateSight> sight_of_cut(const GateDetection& cut, const PictureClock& picture) {
  const Feature::Kind kind =
      cut.method == DetectionMethod::kOpening ? Feature::Kind::kOpening : Feature::Kind::kCorner;
  FixedList<Point, 4> points;
  for (std::uint8_t i = 0; i < 4; ++i)
    if (cut.corner_fitness[i] > 0.0) (void)points.push_back({kind, i, cut.corners_px[i]});
  if (points.size() < 2) return std::nullopt;
  return sight_of({points.begin(), points.size()}, GateSight::Quality::kPart, picture);
}

std::optional<GateSight> sight_of(const LowerCorners& lower, const PictureClock& picture) {
  const std::array<Point, 2> points{{{Feature::Kind::kCorner, 3, lower.bottom_left_px},
                                     {Feature::Kind::kCorner, 2, lower.bottom_right_px}}};
  return sight_of(points, GateSight::Quality::kPart, picture);
}

std::optional<GateSight> sight_of(const GateBars& bars, const PictureClock& picture) {
  const std::array<Point, 2> points{
      {{Feature::Kind::kBar, 0, bars.left_px}, {Feature::Kind::kBar, 1, bars.right_px}}};
  return sight_of(points, GateSight::Quality::kPart, picture);
}

std::optional<Associated> associate(const eskf::ErrorStateFilter& filter, const GateSight& sight,
                                    double max_nis) {
  std::optional<Associated> best;
  double least = std::numeric_limits<double>::infinity(), second = least;
  GateSight one = sight;
  for (one.slot = 0; one.slot < filter.landmarks().slots(); ++one.slot)
    for (const bool behind : {false, true}) {
      one.behind = behind;
      const auto innovation = filter.innovation_of(one);
      if (!innovation || !(innovation->nis < max_nis)) continue;
      const double cost = innovation->nis + innovation->log_det;
      second = std::min(second, std::max(cost, least));
      if (cost >= least) continue;
      least = cost;
      best = Associated{one, *innovation, 0.0};
    }
  if (best) best->margin = second - least;
  return best;
}

}  // namespace gatefly
