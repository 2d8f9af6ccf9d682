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

constexpr int kCeilingLight = 0, kDaylight = 1, kStandLight = 2;

/// The exhibition hall's materials and the random numbers of its clutter.
struct Palette {
  explicit Palette(SceneBuilder& b)
      : floor{b.matt({0.20f, 0.20f, 0.21f}, Pattern::kTiles, {0.14f, 0.14f, 0.15f}, 0.8)},
        carpet{b.matt({0.07f, 0.08f, 0.14f})},
        wall{b.matt({0.50f, 0.51f, 0.52f}, Pattern::kPlanks, {0.44f, 0.45f, 0.46f}, 0.7)},
        roof{b.matt({0.30f, 0.31f, 0.33f}, Pattern::kPlanks, {0.24f, 0.25f, 0.27f}, 0.5)},
        steel{b.matt({0.34f, 0.36f, 0.40f})},
        white{b.matt({0.72f, 0.72f, 0.72f})},
        frame{b.matt({0.05f, 0.055f, 0.07f})},
        wood{b.matt({0.36f, 0.25f, 0.14f}, Pattern::kPlanks, {0.28f, 0.19f, 0.11f}, 5.0)},
        skin{b.matt({0.42f, 0.27f, 0.20f})},
        lamp{b.light({30.0f, 31.0f, 32.0f}, kCeilingLight)},
        glazing{b.material({.albedo = {0.2f, 0.2f, 0.2f},
                            .second = {0.2f, 0.2f, 0.2f},
                            .pattern = Pattern::kBlocks,
                            .scale = 0.9f,
                            .emission = {0.85f, 1.2f, 1.45f},
                            .group = kDaylight})},
        neon{b.light({0.5f, 1.8f, 6.0f}, kStandLight)},
        warm_strip{b.light({5.0f, 3.6f, 1.6f}, kStandLight)} {
    const auto screen = [&](float red, float green, float blue) {
      return b.material({.albedo = {0.3f, 0.3f, 0.3f},
                         .second = {0.2f, 0.2f, 0.2f},
                         .pattern = Pattern::kBlocks,
                         .scale = 2.5f,
                         .emission = {red, green, blue},
                         .group = kStandLight});
    };
    panels = {screen(0.8f, 0.85f, 0.85f), screen(0.15f, 0.4f, 0.9f), screen(0.8f, 0.45f, 0.12f),
              screen(0.25f, 0.6f, 0.3f)};
    banners = {b.matt({0.60f, 0.60f, 0.58f}, Pattern::kBlocks, {0.12f, 0.14f, 0.20f}, 3.0),
               b.matt({0.46f, 0.10f, 0.07f}, Pattern::kBlocks, {0.62f, 0.58f, 0.55f}, 2.0),
               b.matt({0.52f, 0.24f, 0.08f}, Pattern::kBlocks, {0.45f, 0.18f, 0.06f}, 1.5),
               b.matt({0.05f, 0.09f, 0.25f}, Pattern::kBlocks, {0.55f, 0.57f, 0.60f}, 2.5),
               b.matt({0.07f, 0.08f, 0.09f}, Pattern::kBlocks, {0.40f, 0.42f, 0.42f}, 6.0)};
    things = {b.matt({0.60f, 0.60f, 0.58f}), b.matt({0.06f, 0.06f, 0.07f}),
              b.matt({0.36f, 0.09f, 0.06f}), b.matt({0.10f, 0.14f, 0.30f}),
              b.matt({0.40f, 0.22f, 0.10f}), b.matt({0.08f, 0.20f, 0.08f})};
  }

  template <class List>
  int any_of(const List& list) {
    return list[static_cast<std::size_t>(random.uniform() * static_cast<double>(list.size()))];
  }
  bool chance(double share) { return random.uniform() < share; }

  Stream random{1, "exhibition"};
  int floor, carpet, wall, roof, steel, white, frame, wood, skin, lamp, glazing, neon, warm_strip;
  std::array<int, 4> panels{};
  std::array<int, 5> banners{};
  std::array<int, 6> things{};
};

/// Things on a counter.
void add_things(SceneBuilder& b, Palette& p, const FloorFrame& frame, double a0, double a1,
                double b0, double b1, double base, double tallest) {
  for (double a = a0; a < a1 - 0.12; a += p.random.uniform(0.12, 0.5)) {
    const double width = p.random.uniform(0.04, 0.12),
                 c = b0 + p.random.uniform() * (b1 - b0 - 0.1);
    b.box(frame, {a, c, base + 0.001},
          {a + width, c + 0.1, base + p.random.uniform(0.2, 1.0) * tallest}, p.any_of(p.things));
  }
}

/// One side of a stand: panels, some of them back-lit, under a fascia with a light strip.
///
/// In the frame, a runs along the side, b outwards from the stand's wall (0) to `depth`.
void add_stand_side(SceneBuilder& b, Palette& p, const FloorFrame& frame, double half, double depth,
                    double top) {
  const Eigen::Vector3d out = frame.at(0, 1, 0) - frame.at(0, 0, 0);
  const int fields = std::max(1, static_cast<int>(std::lround(2 * half / 1.4)));
  const double pitch = 2 * half / fields;
  for (int i = 0; i < fields; ++i) {
    const double a0 = -half + i * pitch + 0.05, a1 = a0 + pitch - 0.1, kind = p.random.uniform();
    const Eigen::Vector3d corner = frame.at(a0, 0.012, 0.35);
    b.rectangle(corner, frame.at(a1, 0.012, 0.35) - corner, {0, 0, 0.75 - top}, out,
                kind < 0.4 ? p.any_of(p.panels) : p.any_of(p.banners));
    b.bar(frame.at(a0 - 0.01, 0.5 * depth, 0.0), frame.at(a0 - 0.01, 0.5 * depth, top - 0.3), 0.04,
          p.white);
    if (depth > 0.2 && kind > 0.5) {
      b.box(frame, {a0, 0.02, 0.0}, {a1, depth - 0.01, 0.9}, kind > 0.8 ? p.wood : p.white);
      add_things(b, p, frame, a0, a1, 0.02, depth - 0.02, 0.9, std::min(0.5, top - 1.3));
    }
  }
  b.box(frame, {-half, 0.0, top - 0.3}, {half, depth, top}, p.any_of(p.banners));
  const Eigen::Vector3d strip = frame.at(-half + 0.1, depth - 0.05, top - 0.301);
  b.rectangle(strip, frame.at(half - 0.1, depth - 0.05, top - 0.301) - strip,
              frame.at(0, -0.06, 0) - frame.at(0, 0, 0), {0, 0, 1},
              p.chance(0.4) ? p.neon : p.warm_strip);
}

/// A stand open to both long sides of an obstacle's footprint.
void add_stand(SceneBuilder& b, Palette& p, const world::WorldBox& box) {
  const bool turned = box.size.x() < box.size.y();
  const double along = (turned ? box.size.y() : box.size.x()) / 2;
  const double depth = (turned ? box.size.x() : box.size.y()) / 2;
  const double heading = box.heading + (turned ? kPi / 2 : 0.0);
  for (const double turn : {0.0, kPi}) {
    const FloorFrame frame{.origin = box.center, .heading = heading + turn};
    b.box(frame, {-along, 0.0, 0.0}, {along, 0.01, box.top - 0.3}, p.white);
    add_stand_side(b, p, frame, along, depth, box.top);
  }
}

void dress_obstacle(SceneBuilder& b, Palette& p, const world::WorldBox& box) {
  if (box.pole || box.bottom > 0.0) return b.solid_box(box, p.steel);
  if (box.top >= 1.5 && box.size.minCoeff() > 0.5) return add_stand(b, p, box);
  if (box.top >= 1.5) return b.solid_box(box, p.any_of(p.banners));
  const FloorFrame frame{.origin = box.center, .heading = box.heading};
  const double a = box.size.x() / 2, c = box.size.y() / 2, plate = 0.7 * box.top;
  b.box(frame, {-a, -c, 0}, {a, c, plate}, p.chance(0.5) ? p.wood : p.white);
  add_things(b, p, frame, -a, a, -c, c, plate, box.top - plate);
}

/// Stands against a wall, banners above them, doors that are as bright as the day outside.
void dress_wall(SceneBuilder& b, Palette& p, const FloorFrame& wall, double length, double top,
                bool glazed) {
  const Eigen::Vector3d inward = wall.at(0, 1, 0) - wall.at(0, 0, 0);
  const auto pane = [&](double a0, double a1, double h0, double h1, double depth, int material) {
    const Eigen::Vector3d corner = wall.at(a0, depth, h0);
    b.rectangle(corner, wall.at(a1, depth, h0) - corner, {0, 0, h0 - h1}, inward, material);
  };
  if (glazed) {
    for (double a = 1.0; a < length - 2.6; a += 2.4) {
      pane(a, a + 2.2, 0.05, std::min(6.0, top - 0.3), 0.02, p.glazing);
      b.box(wall, {a + 1.08, 0.03, 0.0}, {a + 1.12, 0.08, std::min(6.0, top - 0.3)}, p.frame);
      for (double h = 1.1; h < std::min(6.0, top - 0.4); h += 1.2)
        b.box(wall, {a, 0.03, h}, {a + 2.2, 0.08, h + 0.06}, p.frame);
    }
  }
  for (double a = 0.8; a < length - 4.0;) {
    const double width = p.random.uniform(2.0, 3.6), kind = p.random.uniform();
    const FloorFrame middle{.origin = wall.at(a + 0.5 * width, 0.1, 0).head<2>(),
                            .heading = wall.heading};
    if (kind < 0.5 && !glazed) {
      add_stand_side(b, p, middle, 0.5 * width, 0.29, p.random.uniform(2.2, 2.55));
    } else if (kind < 0.65) {
      add_figure(b,
                 {.origin = wall.at(a + 0.5, 0.2, 0).head<2>(), .heading = wall.heading - kPi / 2},
                 {.height = p.random.uniform(1.55, 1.9),
                  .skin = p.skin,
                  .hair = p.things[1],
                  .shirt = p.any_of(p.things),
                  .trousers = p.things[1]});
    } else if (kind < 0.8) {
      b.box(wall, {a, 0.1, 0.0}, {a + 0.9, 0.13, 2.1}, p.any_of(p.banners));
    } else if (!glazed) {
      pane(a, a + 1.8, 0.0, 2.3, 0.05, p.glazing);  // a door that stands open
    }
    a += width + p.random.uniform(0.2, 1.2);
  }
  for (double a = 3.0; a < length - 4.0 && top > 5.0 && !glazed; a += 7.0)
    b.box(wall, {a, 0.1, 3.2}, {a + 1.6, 0.13, std::min(6.5, top - 0.3)}, p.any_of(p.banners));
}

/// A grid of bright lamps under girders, and banners that hang between them.
void dress_roof(SceneBuilder& b, Palette& p, const world::World& world) {
  const FloorFrame frame{.origin = world.room_center};
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2, top = world.room_size.z();
  if (top < 3.1) return;
  const double high = std::min(1.0, 0.3 * (top - 2.6)), h = top - high;
  for (double a = -x + 2.0; a < x; a += 4.0) {
    for (const double level : {h + 0.1, top - 0.1})
      b.bar(frame.at(a, -y, level), frame.at(a, y, level), 0.12, p.steel);
    for (double c = -y; c < y - 1.0; c += 2.0)
      b.bar(frame.at(a, c, h + 0.1), frame.at(a, c + 1.0, top - 0.1), 0.06, p.steel);
    for (double c = -y + 2.0; c < y - 0.8; c += 4.0) {
      b.rectangle(frame.at(a + 0.3, c, h), {0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 1}, p.lamp);
      b.box(frame, {a + 0.3, c, h + 0.005}, {a + 0.8, c + 0.5, h + 0.09}, p.frame);
    }
  }
  if (h < 4.0) return;
  for (double a = -x + 4.0; a < x - 3.0; a += 6.0)
    for (double c = -y + 5.0; c < y - 4.0; c += 8.0) {
      if (p.chance(0.35)) continue;
      const double low = p.random.uniform(2.7, 4.0), width = p.random.uniform(0.8, 2.4);
      const int banner = p.any_of(p.banners);
      b.box(frame, {a, c, low}, {a + 0.03, c + width, std::min(low + 1.6, h - 0.2)}, banner);
      for (const double end : {c + 0.02, c + width - 0.02})
        b.bar(frame.at(a + 0.015, end, std::min(low + 1.6, h - 0.2)),
              frame.at(a + 0.015, end, top - 0.1), 0.012, p.frame);
    }
}

}  // namespace

void dress_exhibition(SceneBuilder& b, const world::World& world) {
  Palette p{b};
  const FloorFrame room{.origin = world.room_center};
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2, top = world.room_size.z();
  b.rectangle(room.at(-x, -y, 0), {2 * x, 0, 0}, {0, 2 * y, 0}, {0, 0, -1}, p.floor);
  b.rectangle(room.at(-x, -y, top), {2 * x, 0, 0}, {0, 2 * y, 0}, {0, 0, 1}, p.roof);
  for (double c = -y + 4.0; c < y - 3.0; c += 9.0)  // carpets between the stands
    b.rectangle(room.at(-x + 0.5, c, 0.003), {2 * x - 1.0, 0, 0}, {0, 1.6, 0}, {0, 0, -1},
                p.carpet);
  for (int side = 0; side < 4; ++side) {
    const auto [wall, length] = wall_of(world, side);
    const Eigen::Vector3d corner = wall.at(0, 0, 0), inward = wall.at(0, 1, 0) - corner;
    b.rectangle(corner, wall.at(length, 0, 0) - corner, {0, 0, -top}, inward, p.wall);
    dress_wall(b, p, wall, length, top, side == 1);
  }
  dress_roof(b, p, world);
  for (const world::WorldBox& box : world.obstacles) dress_obstacle(b, p, box);
}

}  // namespace gatefly::sim
