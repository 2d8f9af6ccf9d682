// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/scene.hpp"
#include "gatefly/sim/showroom_palette.hpp"

namespace gatefly::sim {
namespace {

using Palette = ShowroomPalette;

/// A thing in a show-case: its back and its underside are never seen.
void add_exhibit(SceneBuilder& b, const FloorFrame& frame, const Eigen::Vector3d& low,
                 const Eigen::Vector3d& high, int material) {
  const auto face = [&](double a, double c, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                        const Eigen::Vector3d& out) {
    b.rectangle(frame.at(a, c, low.z()), u, v, out, material);
  };
  const Eigen::Vector3d origin = frame.at(0, 0, 0);
  const Eigen::Vector3d along = frame.at(1, 0, 0) - origin, out = frame.at(0, 1, 0) - origin;
  const Eigen::Vector3d size = high - low, up{0, 0, -size.z()};
  face(low.x(), high.y(), size.x() * along, up, out);
  face(low.x(), low.y(), size.y() * out, up, -along);
  face(high.x(), low.y(), size.y() * out, up, along);
  b.rectangle(frame.at(low.x(), low.y(), high.z()), size.x() * along, size.y() * out, up, material);
}

/// Exhibits on a shelf: boxes, upright plates, models on thin stands, labels before them.
void add_exhibits(SceneBuilder& b, Palette& p, const FloorFrame& frame, const Eigen::Vector2d& low,
                  const Eigen::Vector2d& high, double base, double tallest, int count) {
  for (int i = 0; i < count; ++i) {
    const double kind = p.random.uniform();
    const double width = kind < 0.3 ? p.random.uniform(0.012, 0.04) : p.random.uniform(0.04, 0.2);
    const double depth = p.random.uniform(0.02, 0.14);
    const Eigen::Vector2d room = (high - low - Eigen::Vector2d{width, depth}).cwiseMax(0.0);
    const double a = low.x() + p.random.uniform() * room.x(),
                 c = low.y() + p.random.uniform() * room.y();
    const double shape = p.random.uniform(), h = (0.1 + 0.9 * shape * shape) * tallest;
    const int material = p.chance(0.06) ? p.any_of(p.warm) : p.any_of(p.things);
    if (kind < 0.85) {
      add_exhibit(b, frame, {a, c, base + 0.001}, {a + width, c + depth, base + h}, material);
    } else {  // a model on a stand: a body and wings across
      const double up = base + 0.5 * tallest;
      b.bar(frame.at(a, c, base), frame.at(a, c, up), 0.012, p.frame);
      add_exhibit(b, frame, {a, c, up}, {std::min(a + 0.26, high.x()), c + 0.03, up + 0.035},
                  material);
      add_exhibit(b, frame, {std::min(a + 0.08, high.x() - 0.08), c, up + 0.035},
                  {std::min(a + 0.16, high.x()), high.y(), up + 0.05}, material);
    }
  }
  for (double a = low.x(); a < high.x() - 0.1; a += p.random.uniform(0.2, 0.5)) {
    const Eigen::Vector3d label = frame.at(a, high.y() + 0.01, base + 0.01);
    b.rectangle(label, frame.at(a + 0.07, high.y() + 0.01, base + 0.01) - label, {0, 0, -0.045},
                frame.at(0, 1, 0) - frame.at(0, 0, 0), p.glass);
  }
}

/// Reflections of lamps and bright things in the glass: streaks, as matt white strips, so that
/// they are as bright as the light that falls on the glass.
void add_reflections(SceneBuilder& b, Palette& p, const FloorFrame& frame, double a0, double a1,
                     double depth, double top) {
  const Eigen::Vector3d out = frame.at(0, 1, 0) - frame.at(0, 0, 0);
  for (int i = 0; i < 2; ++i) {
    const double a = p.random.uniform(a0 + 0.05, a1 - 0.3), h = p.random.uniform(0.3, top - 0.55);
    const Eigen::Vector3d from = frame.at(a, depth - 0.002, h);
    const double slope = p.random.uniform(-0.1, 0.35), width = p.random.uniform(0.008, 0.03);
    if (p.chance(0.5))  // of a lamp overhead
      b.rectangle(from, frame.at(a + 0.25, depth - 0.002, h + slope) - from, {0, 0, -width}, out,
                  p.glass);
    else  // of an edge of another case
      b.rectangle(from, frame.at(a + 0.4 * width, depth - 0.002, h) - from, {0, 0, -0.4}, out,
                  p.glass);
  }
}

}  // namespace

void add_showcase_side(SceneBuilder& b, Palette& p, const FloorFrame& frame, double half,
                       double depth, double top) {
  const int sections = std::max(1, static_cast<int>(std::lround(2 * half / 1.1)));
  const double pitch = 2 * half / sections, shelf = 0.42 * top;
  for (int i = 0; i < sections; ++i) {
    const double a0 = -half + i * pitch, a1 = a0 + pitch;
    for (const auto& [h0, h1] : {std::pair{0.12, shelf}, std::pair{shelf, top - 0.1}}) {
      const Eigen::Vector3d corner = frame.at(a0, 0.01, h0);
      const Eigen::Vector3d towards = frame.at(a0, 1, h0) - corner;
      b.rectangle(corner, frame.at(a1, 0.01, h0) - corner, {0, 0, h0 - h1}, towards,
                  p.any_of(p.glow));
    }
    const Eigen::Vector2d low{a0 + 0.05, 0.04}, high{a1 - 0.05, depth - 0.05};
    add_exhibits(b, p, frame, low, high, 0.12, 0.5, 8);
    add_exhibits(b, p, frame, low, high, shelf + 0.05, 0.45, 9);
    add_exhibits(b, p, frame, {a0 + 0.05, 0.5 * depth}, {a1 - 0.05, 0.6 * depth}, shelf + 0.57, 0.3,
                 5);
    // Glass shelf half way up, seen as its edge; the seam between two panes.
    b.box(frame, {a0, depth * 0.55, shelf + 0.55}, {a1, depth * 0.6, shelf + 0.57}, p.things[8]);
    b.box(frame, {a0 - 0.015, depth - 0.04, 0.1}, {a0 + 0.015, depth, top}, p.frame);
    add_reflections(b, p, frame, a0, a1, depth, top);
  }
  b.box(frame, {-half, 0.02, shelf}, {half, depth - 0.01, shelf + 0.05}, p.shelf);
  const Eigen::Vector3d corner = frame.at(-half + 0.05, depth - 0.005, top - 0.13);
  b.rectangle(corner, frame.at(half - 0.05, depth - 0.005, top - 0.13) - corner, {0, 0, -0.06},
              frame.at(0, 1, 0) - frame.at(0, 0, 0), p.strip);
}

namespace {

/// A back-lit show-case with dark-blue ends, open to both long sides.
void add_showcase(SceneBuilder& b, Palette& p, const world::WorldBox& box) {
  const bool turned = box.size.x() < box.size.y();
  const double along = (turned ? box.size.y() : box.size.x()) / 2;
  const double depth = (turned ? box.size.x() : box.size.y()) / 2;
  const double heading = box.heading + (turned ? kPi / 2 : 0.0);
  const FloorFrame frame{.origin = box.center, .heading = heading};
  b.box(frame, {-along, -depth, 0}, {along, depth, 0.12}, p.frame);
  b.box(frame, {-along, -depth, box.top - 0.07}, {along, depth, box.top}, p.frame);
  for (const double end : {-along, along - 0.06})
    b.box(frame, {end, -depth, 0.12}, {end + 0.06, depth, box.top - 0.07}, p.blue);
  add_showcase_side(b, p, frame, along - 0.06, depth, box.top);
  const FloorFrame back{.origin = box.center, .heading = heading + kPi};
  add_showcase_side(b, p, back, along - 0.06, depth, box.top);
}

/// A table with legs, struts, a shelf of stored things below and more on top; nothing above `top`.
void add_table(SceneBuilder& b, Palette& p, const world::WorldBox& box) {
  const FloorFrame frame{.origin = box.center, .heading = box.heading};
  const double a = box.size.x() / 2, c = box.size.y() / 2;
  const double plate = std::min(0.8, 0.65 * box.top), clutter = box.top - plate;
  b.box(frame, {-a, -c, plate - 0.04}, {a, c, plate},
        p.random.uniform() < 0.5 ? p.any_of(p.woods) : p.things[8]);
  for (const double x : {-a + 0.02, a - 0.06}) {
    for (const double y : {-c + 0.02, c - 0.06})
      b.box(frame, {x, y, 0}, {x + 0.04, y + 0.04, plate}, p.frame);
    b.bar(frame.at(x + 0.02, -c + 0.04, 0.06), frame.at(x + 0.02, c - 0.04, plate - 0.08), 0.02,
          p.frame);
  }
  for (const double y : {-c + 0.03, c - 0.05})
    b.bar(frame.at(-a + 0.04, y, plate - 0.08), frame.at(a - 0.04, y, 0.06), 0.02, p.shelf);
  const int count = static_cast<int>(4 + 5 * a * c * 4);
  add_small_things(b, p, frame, {-a, -c}, {a, c}, plate, clutter, count);
  add_small_things(b, p, frame, {-a + 0.1, -c + 0.1}, {a - 0.1, c - 0.1}, 0.0, plate - 0.1,
                   count / 2);
  // A frame of thin bars lies on top: an engine's mount, a half-built fuselage.
  const double low = plate + 0.02, high = box.top - 0.02;
  for (double x = -a + 0.1; x < a - 0.35; x += 0.3) {
    b.bar(frame.at(x, -0.6 * c, low), frame.at(x + 0.3, -0.6 * c, high), 0.015, p.silver);
    b.bar(frame.at(x + 0.3, 0.6 * c, low), frame.at(x, 0.6 * c, high), 0.015, p.silver);
    b.bar(frame.at(x, -0.6 * c, high), frame.at(x, 0.6 * c, high), 0.015, p.yellow);
  }
}

/// A column with a sign on each side.
void add_column(SceneBuilder& b, Palette& p, const world::WorldBox& box, double ceiling) {
  const FloorFrame frame{.origin = box.center, .heading = box.heading};
  const double a = box.size.x() / 2, c = box.size.y() / 2;
  const bool tall = box.top > 1.9;
  b.box(frame, {-a, -c, 0}, {a, c, tall ? ceiling : box.top}, p.column);
  if (!tall) return;
  for (const double side : {-1.0, 1.0}) {
    const double h = p.random.uniform(0.9, 1.6), y = side * (c + 0.0005), x = side * (a + 0.0005);
    const int sign = p.chance(0.4) ? p.any_of(p.warm) : p.any_of(p.posters);
    b.rectangle(frame.at(-0.7 * a, y, h), frame.at(1.4 * a, 0, 0) - frame.at(0, 0, 0),
                {0, 0, -0.28}, frame.at(0, side, 0) - frame.at(0, 0, 0), sign);
    b.rectangle(frame.at(x, -0.7 * c, h - 0.3), frame.at(0, 1.4 * c, 0) - frame.at(0, 0, 0),
                {0, 0, -0.24}, frame.at(side, 0, 0) - frame.at(0, 0, 0), p.any_of(p.posters));
  }
}

void dress_obstacle(SceneBuilder& b, Palette& p, const world::WorldBox& box, double ceiling) {
  const double longest = box.size.maxCoeff(), area = box.size.prod();
  const FloorFrame frame{.origin = box.center, .heading = box.heading};
  const double a = box.size.x() / 2, c = box.size.y() / 2;
  if (box.pole || box.bottom > 0.0) return b.solid_box(box, box.pole ? p.pipe : p.beam);
  if (longest <= 0.45) return add_column(b, p, box, ceiling);
  if (box.top >= 1.5 && area >= 1.5 && box.size.minCoeff() > 0.5) return add_showcase(b, p, box);
  if (box.top >= 1.5) return b.box(frame, {-a, -c, 0}, {a, c, box.top}, p.blue);
  add_table(b, p, box);
}

/// Things flat on the floor: mats, cables' covers, tape, the warm shine of lamps in the varnish.
void dress_floor(SceneBuilder& b, Palette& p, const world::World& world) {
  const FloorFrame room{.origin = world.room_center};
  const double x = 0.5 * world.room_size.x() - 1.0, y = 0.5 * world.room_size.y() - 1.0;
  const int count = static_cast<int>(0.06 * world.room_size.x() * world.room_size.y());
  for (int i = 0; i < count; ++i) {
    const FloorFrame at{
        .origin = room.at(p.random.uniform(-x, x), p.random.uniform(-y, y), 0).head<2>(),
        .heading = p.chance(0.5) ? 0.0 : kPi / 2};
    const double kind = p.random.uniform(), h = 0.002 + 1e-4 * i;
    const double width = kind < 0.5 ? 0.05 : p.random.uniform(0.15, 0.5);
    const double length = kind < 0.5 ? p.random.uniform(0.6, 1.6) : p.random.uniform(0.3, 0.9);
    const int material = kind < 0.15  ? p.any_of(p.warm)
                         : kind < 0.3 ? p.yellow
                                      : p.any_of(p.things);
    b.rectangle(at.at(0, 0, h), at.at(length, 0, h) - at.at(0, 0, h),
                at.at(0, width, h) - at.at(0, 0, h), {0, 0, -1}, material);
  }
}

}  // namespace

void dress_showroom(SceneBuilder& b, const world::World& world) {
  Palette p{b};
  const FloorFrame room{.origin = world.room_center};
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2, top = world.room_size.z();
  b.rectangle(room.at(-x, -y, 0), {2 * x, 0, 0}, {0, 2 * y, 0}, {0, 0, -1}, p.floor);
  b.rectangle(room.at(-x, -y, top), {2 * x, 0, 0}, {0, 2 * y, 0}, {0, 0, 1}, p.ceiling);
  for (int side = 0; side < 4; ++side) {
    const auto [wall, length] = wall_of(world, side);
    const Eigen::Vector3d corner = wall.at(0, 0, 0);
    b.rectangle(corner, wall.at(length, 0, 0) - corner, {0, 0, -top}, wall.at(0, 1, 0) - corner,
                p.wall);
    dress_showroom_wall(b, p, wall, length);
  }
  dress_floor(b, p, world);
  dress_showroom_ceiling(b, p, world);
  for (const world::WorldBox& box : world.obstacles) dress_obstacle(b, p, box, top);
}

}  // namespace gatefly::sim
