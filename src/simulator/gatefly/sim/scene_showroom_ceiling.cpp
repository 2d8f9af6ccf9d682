// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/scene.hpp"
#include "gatefly/sim/scene_aviation.hpp"
#include "gatefly/sim/showroom_palette.hpp"

namespace gatefly::sim {
namespace {

/// A lamp with a prismatic cover: two slanted panes, seen from afar as well as from below.
void add_lamp(SceneBuilder& b, const ShowroomPalette& p, const FloorFrame& frame, double length,
              double h) {
  const Eigen::Vector3d along = frame.at(length, 0, 0) - frame.at(0, 0, 0);
  const Eigen::Vector3d ridge = frame.at(0, 0, h);
  for (const double side : {-0.09, 0.09}) {
    const Eigen::Vector3d up = frame.at(0, side, h + 0.05) - ridge;
    b.rectangle(ridge, along, up, frame.at(0, side, h - 0.09) - ridge, p.lamp);
  }
  b.box(frame, {0, -0.1, h + 0.051}, {length, 0.1, h + 0.1}, p.pipe);
  for (const double a : {0.15, length - 0.15})
    b.bar(frame.at(a, 0, h + 0.1), frame.at(a, 0, h + 0.3), 0.012, p.frame);
}

/// Straight sheet-metal ducts along the room, with seams and hangers.
void add_duct(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& frame, double x, double c,
              double top) {
  const double width = p.random.uniform(0.35, 0.6), low = 2.64;
  b.box(frame, {-x, c, low}, {x, c + width, top - 0.06}, p.silver);
  for (double a = -x + 0.8; a < x - 0.5; a += 1.5)
    b.box(frame, {a, c - 0.02, low - 0.02}, {a + 0.05, c + width + 0.02, top - 0.05}, p.pipe);
}

/// A tray of cables: rungs seen from below.
void add_tray(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& frame, double x, double c) {
  const double h = p.random.uniform(2.7, 2.8);
  for (const double y : {c, c + 0.25}) b.bar(frame.at(-x, y, h), frame.at(x, y, h), 0.04, p.pipe);
  for (double a = -x + 0.2; a < x; a += 0.45)
    b.bar(frame.at(a, c, h), frame.at(a, c + 0.25, h), 0.03, p.beam);
}

void add_spot(SceneBuilder& b, const ShowroomPalette& p, const FloorFrame& frame, double a,
              double c) {
  b.rectangle(frame.at(a, c, 2.7), {0.08, 0, 0}, {0, 0.08, 0}, {0, 0, 1}, p.spot);
  b.box(frame, {a, c, 2.705}, {a + 0.08, c + 0.08, 2.85}, p.things[8]);
}

/// A lamp, sometimes another across it, and a spot in each field of the grid.
void add_lamps(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& frame, double x, double y,
               double top) {
  for (double a = -x + 1.6; a < x - 1.6; a += 2.4) {
    for (double c = -y + 1.5; c < y - 1.5; c += 1.9) {
      const double da = p.random.uniform(-0.3, 0.3), dc = p.random.uniform(-0.4, 0.4);
      if (p.chance(0.1)) continue;
      const FloorFrame lamp{.origin = frame.at(a + da, c + dc, 0).head<2>(),
                            .heading = p.chance(0.5) ? 0.0 : kPi / 2};
      add_lamp(b, p, lamp, 1.25, p.random.uniform(2.66, top - 0.38));
      add_spot(b, p, frame, a + da - 0.5, c + dc + 0.4);
    }
  }
}

}  // namespace

void dress_showroom_ceiling(SceneBuilder& b, ShowroomPalette& p, const world::World& world) {
  const FloorFrame frame{.origin = world.room_center};
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2, top = world.room_size.z();
  if (top < 3.05) return;
  for (double a = -x + 1.2; a < x; a += 2.4)
    b.box(frame, {a, -y, top - 0.28}, {a + 0.2, y, top - 0.001}, p.beam);
  for (double c = -y + 0.8; c < y - 0.8; c += 3.1) {
    const double low = p.random.uniform(2.65, 2.8), width = p.random.uniform(0.06, 0.16);
    b.box(frame, {-x, c, low}, {x, c + width, low + width}, p.chance(0.5) ? p.pipe : p.beam);
    b.box(frame, {-x, c + 0.35, top - 0.4}, {x, c + 0.42, top - 0.33}, p.pipe);
    if (p.chance(0.5)) add_tray(b, p, frame, x, c + 1.0);
    if (p.chance(0.4)) add_duct(b, p, frame, x, c + 1.6, top);
  }
  add_lamps(b, p, frame, x, y, top);
  const int aircraft = static_cast<int>(x * y / 14);
  for (int i = 0; i < aircraft && x > 4.0 && y > 4.0; ++i) {
    const FloorFrame nose{
        .origin =
            frame.at(p.random.uniform(-x + 3, x - 3), p.random.uniform(-y + 3, y - 3), 0).head<2>(),
        .heading = p.random.uniform(-kPi, kPi)};
    add_hanging_aircraft(b, p, nose, 2.62, top);
  }
}

}  // namespace gatefly::sim
