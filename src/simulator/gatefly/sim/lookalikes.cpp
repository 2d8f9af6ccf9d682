// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/lookalikes.hpp"

#include <algorithm>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::sim {
namespace {

/// One upright bar in a picture: its outer ends.
struct Bar {
  int number;
  Eigen::Vector2d top_px, bottom_px;
};

std::vector<Bar> bars_of(std::span<const GateView> views) {
  std::vector<Bar> bars;
  for (const GateView& view : views) {
    if (view.seen[0] && view.seen[3])
      bars.push_back({2 * view.gate, view.corners_px[0], view.corners_px[3]});
    if (view.seen[1] && view.seen[2])
      bars.push_back({2 * view.gate + 1, view.corners_px[1], view.corners_px[2]});
  }
  return bars;
}

/// The corners of a thing's upper and lower face; a pole's seen from `eye`.
std::array<Eigen::Vector3d, 8> corners_of(const world::WorldBox& box,
                                          const Eigen::Vector3d& eye_E) {
  double heading = box.heading;
  Eigen::Vector2d half = 0.5 * box.size;
  if (box.pole) {
    const Eigen::Vector2d off = eye_E.head<2>() - box.center;
    heading = gatefly::atan2(off.y(), off.x());
    half = Eigen::Vector2d::Constant(0.5 * box.size.x());
  }
  const auto [s, c] = sincos(heading);
  std::array<Eigen::Vector3d, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const double x = (i & 1) ? half.x() : -half.x(), y = (i & 2) ? half.y() : -half.y();
    corners[static_cast<std::size_t>(i)] = {box.center.x() + c * x - s * y,
                                            box.center.y() + s * x + c * y,
                                            (i & 4) ? -box.top : -box.bottom};
  }
  return corners;
}

/// Nothing solid before a point but what it is on, which is at most `depth` before it.
bool in_sight(const Sight& sight, const Eigen::Vector3d& eye_E, const Eigen::Vector3d& p_E,
              double depth) {
  const Eigen::Vector3d way = p_E - eye_E;
  const double distance = way.norm();
  return distance > depth && sight.range(eye_E, way / distance, distance) > distance - depth;
}

}  // namespace

std::vector<LookAlike> frames_of_two(std::span<const GateView> views) {
  constexpr int kMany = 1000;
  const std::vector<Bar> bars = bars_of(views);
  std::vector<LookAlike> frames;
  for (const Bar& left : bars)
    for (const Bar& right : bars) {
      if (left.number / 2 == right.number / 2 || left.top_px.x() >= right.top_px.x()) continue;
      const std::array<Eigen::Vector2d, 4> corners{left.top_px, right.top_px, right.bottom_px,
                                                   left.bottom_px};
      if (detectable(corners)) frames.push_back({kMany * left.number + right.number, corners});
    }
  return frames;
}

std::vector<LookAlike> decoys_in_view(const world::World& world, const Sight& sight,
                                      Exposure& exposure) {
  std::vector<LookAlike> views;
  for (std::size_t i = 0; i < world.decoys.size(); ++i) {
    const world::WorldBox& box = world.decoys[i].shape;
    const Eigen::Vector3d middle_E{box.center.x(), box.center.y(), -0.5 * (box.top + box.bottom)};
    const Eigen::Vector3d eye_E = exposure.eye_E();
    const auto middle = exposure.project(middle_E);
    if (!middle || !exposure.inside(*middle) ||
        !in_sight(sight, eye_E, middle_E, 0.5 * box.size.norm() + 0.05))
      continue;
    Eigen::Vector2d low{1e9, 1e9}, high{-1e9, -1e9};
    for (const Eigen::Vector3d& corner_E : corners_of(box, eye_E))
      if (const auto px = exposure.project(corner_E))
        low = low.cwiseMin(*px), high = high.cwiseMax(*px);
    views.push_back(
        {static_cast<int>(i),
         {low, Eigen::Vector2d{high.x(), low.y()}, high, Eigen::Vector2d{low.x(), high.y()}}});
  }
  return views;
}

std::vector<Place> places_of(const world::World& world, std::uint64_t seed) {
  constexpr int kPlaces = 12;
  constexpr double kOffWall = 0.1;  // [m]
  Stream stream{seed, "ideal places"};
  std::vector<Place> places;
  const Eigen::Vector2d half =
      0.5 * world.room_size.head<2>() - Eigen::Vector2d::Constant(kOffWall);
  for (int i = 0; i < kPlaces; ++i) {
    const double along = stream.uniform(-1.0, 1.0), height = stream.uniform(0.3, 1.0);
    const Eigen::Vector2d at =
        i % 4 < 2 ? Eigen::Vector2d{i % 2 ? half.x() : -half.x(), along * half.y()}
                  : Eigen::Vector2d{along * half.x(), i % 2 ? half.y() : -half.y()};
    const Eigen::Vector2d p = world.room_center + at;
    const double size = stream.uniform(), chance = stream.normal();
    places.push_back({{p.x(), p.y(), -height * std::min(world.room_size.z(), 3.2)}, size, chance});
  }
  return places;
}

std::vector<int> places_in_view(std::span<const Place> places, const Sight& sight,
                                Exposure& exposure) {
  std::vector<int> seen;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d eye_E = exposure.eye_E();
    const auto px = exposure.project(places[i].p_E);
    if (px && exposure.inside(*px) && in_sight(sight, eye_E, places[i].p_E, 0.3))
      seen.push_back(static_cast<int>(i));
  }
  return seen;
}

}  // namespace gatefly::sim
