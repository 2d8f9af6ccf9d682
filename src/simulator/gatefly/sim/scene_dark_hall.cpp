// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/sim/scene.hpp"
#include "gatefly/sim/scene_figure.hpp"

namespace gatefly::sim {
namespace {

constexpr int kCeilingLight = 0, kWorkshopLight = 1, kSpotLight = 2;

/// The dark hall's materials and the random numbers of its clutter.
struct Palette {
  explicit Palette(SceneBuilder& b)
      : turf{b.matt({0.040f, 0.062f, 0.034f}, Pattern::kGrain, {0.033f, 0.053f, 0.029f}, 0.9)},
        mat{b.matt({0.035f, 0.085f, 0.20f})},
        curtain{b.matt({0.008f, 0.007f, 0.011f}, Pattern::kGrain, {0.006f, 0.0055f, 0.0085f}, 1.2)},
        roof{b.matt({0.014f, 0.014f, 0.017f}, Pattern::kGrain, {0.008f, 0.008f, 0.010f}, 0.6)},
        truss{b.matt({0.30f, 0.30f, 0.30f})},
        net{b.matt({0.02f, 0.02f, 0.022f})},
        wood{b.matt({0.42f, 0.27f, 0.11f})},
        screen{b.matt({0.30f, 0.30f, 0.29f}, Pattern::kGrain, {0.24f, 0.24f, 0.23f}, 1.5)},
        forest{b.matt({0.09f, 0.07f, 0.045f}, Pattern::kBlocks, {0.028f, 0.028f, 0.022f}, 6.0)},
        dark{b.matt({0.03f, 0.03f, 0.035f}, Pattern::kBlocks, {0.055f, 0.055f, 0.06f}, 3.0)},
        skin{b.matt({0.38f, 0.25f, 0.19f})},
        lamp{b.light({6.0f, 6.0f, 5.8f}, kCeilingLight)},
        white{b.material({.albedo = {0.5f, 0.5f, 0.5f},
                          .second = {0.4f, 0.4f, 0.4f},
                          .pattern = Pattern::kBlocks,
                          .scale = 1.3f,
                          .emission = {0.045f, 0.058f, 0.050f},
                          .group = kWorkshopLight})},
        door{b.light({0.6f, 0.64f, 0.64f}, kWorkshopLight)},
        beacon{b.light({0.5f, 0.02f, 0.02f}, kSpotLight)} {
    things = {b.matt({0.30f, 0.30f, 0.30f}), b.matt({0.03f, 0.03f, 0.035f}),
              b.matt({0.05f, 0.10f, 0.28f}), b.matt({0.36f, 0.22f, 0.09f}),
              b.matt({0.34f, 0.10f, 0.06f}), b.matt({0.44f, 0.44f, 0.42f})};
  }

  int thing() { return things[static_cast<std::size_t>(random.uniform() * 6.0)]; }

  Stream random{1, "dark hall"};
  int turf, mat, curtain, roof, truss, net, wood, screen, forest, dark, skin, lamp, white, door,
      beacon;
  std::array<int, 6> things{};
};

/// A lattice girder: four tubes and diagonals, `size` wide, from one point to another.
void add_truss(SceneBuilder& b, const Palette& p, const Eigen::Vector3d& from,
               const Eigen::Vector3d& to, const Eigen::Vector3d& side, const Eigen::Vector3d& up) {
  const Eigen::Vector3d along = to - from;
  const int fields = std::max(1, static_cast<int>(along.norm() / 0.5));
  for (const auto& corner : {Eigen::Vector3d{0, 0, 0}, side, up, Eigen::Vector3d{side + up}})
    b.bar(from + corner, to + corner, 0.05, p.truss);
  for (int i = 0; i < fields; ++i) {
    const Eigen::Vector3d one = from + along * i / fields, two = from + along * (i + 1) / fields;
    const bool odd = i % 2 == 1;
    b.bar(odd ? one : one + up, odd ? two + up : two, 0.025, p.truss);
  }
}

/// The side that is open to a workshop: a bright wall, desks, people and a net before them.
void dress_workshop(SceneBuilder& b, Palette& p, const FloorFrame& wall, double length,
                    double top) {
  const Eigen::Vector3d inward = wall.at(0, 1, 0) - wall.at(0, 0, 0);
  const auto pane = [&](double a0, double a1, double h0, double h1, double depth, int material) {
    const Eigen::Vector3d corner = wall.at(a0, depth, h0);
    b.rectangle(corner, wall.at(a1, depth, h0) - corner, {0, 0, h0 - h1}, inward, material);
  };
  pane(0.3, length - 0.3, 0.0, 2.2, 0.01, p.white);
  pane(length - 1.3, length - 0.4, 0.0, std::min(3.0, top - 0.2), 0.02, p.door);
  for (double a = 0.4; a < length - 2.0; a += p.random.uniform(1.0, 1.8)) {
    b.box(wall, {a, 0.05, 0.70}, {a + 0.95, 0.32, 0.74}, p.wood);
    b.bar(wall.at(a + 0.05, 0.2, 0), wall.at(a + 0.05, 0.2, 0.7), 0.04, p.truss);
    for (int i = 0; i < 4; ++i) {
      const double x = a + p.random.uniform(0.0, 0.7), w = p.random.uniform(0.08, 0.4);
      b.box(wall, {x, 0.1, 0.741}, {x + std::min(w, 0.25), 0.25, 0.74 + w}, p.thing());
    }
    if (p.random.uniform() < 0.3)
      add_figure(b,
                 {.origin = wall.at(a + 0.5, 0.17, 0).head<2>(), .heading = wall.heading + kPi / 2},
                 {.height = p.random.uniform(1.5, 1.85),
                  .skin = p.skin,
                  .hair = p.things[1],
                  .shirt = p.thing(),
                  .trousers = p.things[1]});
    else if (p.random.uniform() < 0.5)
      b.box(wall, {a, 0.03, 0.0}, {a + 0.6, 0.3, p.random.uniform(1.2, 2.0)}, p.dark);
  }
  for (double a = 0.3; a < length - 0.2; a += 0.45)  // the net's ropes
    b.bar(wall.at(a, 0.37, 0.0), wall.at(a, 0.37, 2.2), 0.008, p.net);
  for (double h = 0.3; h < 2.2; h += 0.45)
    b.bar(wall.at(0.2, 0.37, h), wall.at(length - 0.2, 0.37, h), 0.008, p.net);
}

/// Screens with pictures and wheels of furniture before the curtain; not many.
void dress_curtain(SceneBuilder& b, Palette& p, const FloorFrame& wall, double length) {
  for (double a = 0.8; a < length - 2.4; a += p.random.uniform(2.5, 5.0)) {
    const double kind = p.random.uniform(), width = p.random.uniform(1.1, 1.9);
    if (kind < 0.3) {
      b.box(wall, {a, 0.25, 0.25}, {a + width, 0.28, 2.1}, p.screen);
      b.box(wall, {a + 0.2, 0.28, 0.9}, {a + 0.6, 0.29, 1.3}, p.thing());
      for (const double x : {a + 0.1, a + width - 0.1})
        b.bar(wall.at(x, 0.1, 0.03), wall.at(x, 0.39, 0.03), 0.05, p.truss);
    } else if (kind < 0.55) {
      b.box(wall, {a, 0.2, 0.5}, {a + width, 0.23, 2.2}, p.forest);
    } else if (kind < 0.7) {
      b.box(wall, {a, 0.1, 0.0}, {a + 0.5, 0.38, p.random.uniform(0.3, 0.9)}, p.thing());
    }
  }
}

/// Trusses round the room and in its corners, carrying the nets.
void dress_trusses(SceneBuilder& b, Palette& p, const FloorFrame& wall, double length, double top) {
  const Eigen::Vector3d origin = wall.at(0, 0, 0);
  const Eigen::Vector3d in = wall.at(0, 0.22, 0) - origin, along = wall.at(0.22, 0, 0) - origin;
  add_truss(b, p, wall.at(0.05, 0.1, 2.25), wall.at(length - 0.05, 0.1, 2.25), in, {0, 0, -0.22});
  add_truss(b, p, wall.at(0.1, 0.1, 0.0), wall.at(0.1, 0.1, top - 0.05), along, in);
  b.rectangle(wall.at(0.0, 0.0, 0.004), wall.at(length, 0, 0) - origin, wall.at(0, 0.4, 0) - origin,
              {0, 0, -1}, p.mat);
}

/// A few long lamps far apart, girders between them, red points of a motion-capture system.
void dress_roof(SceneBuilder& b, Palette& p, const world::World& world) {
  const FloorFrame frame{.origin = world.room_center};
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2, top = world.room_size.z();
  if (top < 2.95) return;
  const double h = top - 0.12;
  for (double a = -x + 1.2; a < x - 0.8; a += 4.5)
    for (double c = -0.5 * y; c < y - 1.6; c += std::max(3.2, y)) {
      b.rectangle(frame.at(a, c, h), {0.16, 0, 0}, {0, std::min(3.0, 0.6 * y), 0}, {0, 0, 1},
                  p.lamp);
      b.box(frame, {a, c, h + 0.005}, {a + 0.16, c + 1.5, top - 0.001}, p.net);
    }
  for (double a = -x + 2.6; a < x - 0.5; a += 4.5)
    add_truss(b, p, frame.at(a, -y + 0.1, top - 0.3), frame.at(a, y - 0.1, top - 0.3), {0.22, 0, 0},
              {0, 0, -0.2});
  for (double a = -x + 0.6; a < x; a += 2.7)
    for (const double c : {-y + 0.3, y - 0.35})
      b.rectangle(frame.at(a, c, std::max(2.62, top - 0.5)), {0.05, 0, 0}, {0, 0, 0.05}, {0, -c, 0},
                  p.beacon);
}

}  // namespace

void dress_dark_hall(SceneBuilder& b, const world::World& world) {
  Palette p{b};
  const FloorFrame room{.origin = world.room_center};
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2, top = world.room_size.z();
  b.rectangle(room.at(-x, -y, 0), {2 * x, 0, 0}, {0, 2 * y, 0}, {0, 0, -1}, p.turf);
  b.rectangle(room.at(-x, -y, top), {2 * x, 0, 0}, {0, 2 * y, 0}, {0, 0, 1}, p.roof);
  for (int side = 0; side < 4; ++side) {
    const auto [wall, length] = wall_of(world, side);
    const Eigen::Vector3d corner = wall.at(0, 0, 0), inward = wall.at(0, 1, 0) - corner;
    b.rectangle(corner, wall.at(length, 0, 0) - corner, {0, 0, -top}, inward, p.curtain);
    if (side == 1)
      dress_workshop(b, p, wall, length, top);
    else
      dress_curtain(b, p, wall, length);
    if (top > 2.6) dress_trusses(b, p, wall, length, top);
  }
  dress_roof(b, p, world);
  for (const world::WorldBox& box : world.obstacles) b.solid_box(box, box.pole ? p.truss : p.dark);
}

}  // namespace gatefly::sim
