// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/scene.hpp"

namespace gatefly::sim {
namespace {

constexpr int kCeilingLight = 0, kWindowLight = 1, kSpotLight = 2;

/// The hall's materials and the random numbers of its clutter.
struct Palette {
  explicit Palette(SceneBuilder& b)
      : floor{b.material({.albedo = {0.39f, 0.36f, 0.27f},
                          .second = {0.35f, 0.33f, 0.245f},
                          .pattern = Pattern::kGrain,
                          .scale = 0.7f})},
        stripe{b.matt({0.20f, 0.21f, 0.19f})},
        siding{b.matt({0.49f, 0.46f, 0.39f}, Pattern::kPlanks, {0.32f, 0.32f, 0.30f}, 2.2)},
        net{b.matt({0.066f, 0.066f, 0.056f}, Pattern::kGrain, {0.044f, 0.048f, 0.042f}, 2.5)},
        roof{b.matt({0.12f, 0.125f, 0.12f}, Pattern::kPlanks, {0.09f, 0.095f, 0.09f}, 1.0)},
        wood{b.matt({0.43f, 0.33f, 0.15f}, Pattern::kPlanks, {0.37f, 0.28f, 0.13f}, 3.0)},
        blue{b.matt({0.035f, 0.06f, 0.17f})},
        dark{b.matt({0.066f, 0.056f, 0.064f}, Pattern::kBlocks, {0.045f, 0.042f, 0.05f}, 2.0)},
        metal{b.matt({0.42f, 0.43f, 0.42f})},
        lamp{b.light({14.0f, 12.5f, 10.5f}, kCeilingLight)},
        window{b.light({2.4f, 2.7f, 2.8f}, kWindowLight)},
        spot{b.light({32.0f, 32.0f, 30.0f}, kSpotLight)} {
    things = {b.matt({0.50f, 0.47f, 0.38f}), b.matt({0.05f, 0.05f, 0.06f}),
              b.matt({0.04f, 0.12f, 0.06f}), b.matt({0.05f, 0.07f, 0.20f}),
              b.matt({0.30f, 0.20f, 0.12f}), b.matt({0.25f, 0.10f, 0.08f})};
  }

  int thing() { return things[static_cast<std::size_t>(random.uniform() * 6.0)]; }

  Stream random{1, "hall"};
  int floor, stripe, siding, net, roof, wood, blue, dark, metal, lamp, window, spot;
  std::array<int, 6> things{};
};

/// Panels, cupboards, pillars and nets along one wall; a runs along it, b into the room.
void dress_wall(SceneBuilder& b, Palette& p, const FloorFrame& wall, double length, double top,
                bool net) {
  const double panels = std::min(2.3, top - 0.4);
  if (net) {
    b.box(wall, {0.05, 0.30, 0.35}, {length - 0.05, 0.32, top - 0.05}, p.net);
    b.box(wall, {0.05, 0.25, panels}, {length - 0.05, 0.37, panels + 0.08}, p.metal);  // truss
    for (double a = 0.3; a < length - 1.0; a += p.random.uniform(0.5, 1.4))
      b.box(wall, {a, 0.02, 0}, {a + 0.4, 0.28, 0.35}, p.thing());
  }
  for (double a = 0.6; a < length - 2.0;) {
    const double width = p.random.uniform(0.8, 2.0), kind = p.random.uniform();
    const double out = net ? 0.38 : 0.3;
    if (kind < 0.28)
      b.box(wall, {a, 0.0, 0}, {a + width, out, panels - p.random.uniform(0.0, 0.5)}, p.wood);
    else if (kind < 0.55)
      b.box(wall, {a, 0.0, 0}, {a + width, out, p.random.uniform(1.0, 1.7)}, p.dark);
    else if (kind < 0.70)
      b.box(wall, {a, 0.0, 0}, {a + 0.7, out, p.random.uniform(1.0, 1.6)}, p.blue);
    else if (kind < 0.85)
      for (double h = 0.0; h < 1.2; h += 0.3)
        b.box(wall, {a, 0.1, h + 0.001}, {a + 0.3, out, h + 0.28}, p.thing());
    a += width + p.random.uniform(0.1, 0.8);
  }
  for (double a = 2.2; a < length - 1.0 && !net; a += 4.5) {
    b.box(wall, {a, 0.0, 0}, {a + 0.18, 0.18, top}, p.blue);
    b.box(wall, {0.0, 0.0, top - 1.3}, {length, 0.12, top - 1.22}, p.blue);
  }
}

void dress_roof(SceneBuilder& b, Palette& p, const world::World& world) {
  const FloorFrame frame{.origin = world.room_center};
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2, top = world.room_size.z();
  const double h = top - 0.15;
  for (double a = -x + 1.5; a < x; a += 3.0) {
    b.box(frame, {a, -y, top - 0.12}, {a + 0.15, y, top - 0.001}, p.blue);
    for (double c = -y + 1.2; c < y - 1.0; c += 3.3) {
      b.rectangle(frame.at(a + 0.4, c, h), {0.3, 0, 0}, {0, 1.3, 0}, {0, 0, 1}, p.lamp);
      b.box(frame, {a + 0.4, c, h + 0.005}, {a + 0.7, c + 1.3, top - 0.001}, p.metal);
    }
    const double c = p.random.uniform(-0.8 * y, 0.8 * y);
    b.rectangle(frame.at(a, c, std::max(2.65, top - 0.7)), {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 1},
                p.spot);
  }
}

}  // namespace

void dress_hall(SceneBuilder& b, const world::World& world) {
  Palette p{b};
  const FloorFrame room{.origin = world.room_center};
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2, top = world.room_size.z();
  b.rectangle(room.at(-x, -y, 0), {2 * x, 0, 0}, {0, 2 * y, 0}, {0, 0, -1}, p.floor);
  b.rectangle(room.at(-x, -y, top), {2 * x, 0, 0}, {0, 2 * y, 0}, {0, 0, 1}, p.roof);
  for (double c = -y + 1.3; c < y; c += 3.7)  // lines on the floor
    b.rectangle(room.at(-x, c, 0.002), {2 * x, 0, 0}, {0, 0.12, 0}, {0, 0, -1}, p.stripe);
  for (int side = 0; side < 4; ++side) {
    const auto [wall, length] = wall_of(world, side);
    const Eigen::Vector3d corner = wall.at(0, 0, 0), inward = wall.at(0, 1, 0) - corner;
    b.rectangle(corner, wall.at(length, 0, 0) - corner, {0, 0, -top}, inward, p.siding);
    const bool net = side == 1 || side == 2;
    dress_wall(b, p, wall, length, top, net);
    if (net || top < 3.0) continue;
    for (double a = 1.0; a < length - 1.6; a += 3.4) {
      const Eigen::Vector3d pane = wall.at(a, 0.02, top - 0.9);
      b.rectangle(pane, wall.at(a + 1.5, 0.02, top - 0.9) - pane, {0, 0, -0.6}, inward, p.window);
    }
  }
  dress_roof(b, p, world);
  for (const world::WorldBox& box : world.obstacles) b.solid_box(box, box.pole ? p.metal : p.dark);
}

}  // namespace gatefly::sim
