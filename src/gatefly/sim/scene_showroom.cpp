// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/scene.hpp"

namespace gatefly::sim {
namespace {

constexpr int kCeilingLight = 0, kShowcaseLight = 1, kSpotLight = 2;

/// The showroom's materials, and the random numbers of its clutter (the same in every race).
struct Palette {
  explicit Palette(SceneBuilder& b)
      : floor{b.material({.albedo = {0.30f, 0.32f, 0.31f},
                          .second = {0.265f, 0.29f, 0.28f},
                          .pattern = Pattern::kGrain,
                          .scale = 0.6f})},
        wall{b.matt({0.42f, 0.42f, 0.40f}, Pattern::kGrain, {0.34f, 0.34f, 0.33f}, 1.3)},
        ceiling{b.matt({0.34f, 0.34f, 0.33f}, Pattern::kBlocks, {0.26f, 0.26f, 0.26f}, 0.8)},
        beam{b.matt({0.13f, 0.13f, 0.13f})},
        pipe{b.matt({0.5f, 0.5f, 0.48f})},
        column{b.matt({0.55f, 0.55f, 0.52f}, Pattern::kGrain, {0.48f, 0.48f, 0.46f}, 3.0)},
        blue{b.matt({0.045f, 0.052f, 0.090f}, Pattern::kGrain, {0.055f, 0.062f, 0.105f}, 2.0)},
        shelf{b.matt({0.07f, 0.12f, 0.32f})},
        frame{b.matt({0.03f, 0.035f, 0.05f})},
        lamp{b.light({11.0f, 10.4f, 9.6f}, kCeilingLight)},
        strip{b.light({7.0f, 7.2f, 6.8f}, kShowcaseLight)},
        spot{b.light({30.0f, 26.0f, 20.0f}, kSpotLight)} {
    const auto panel = [&](float red, float green, float blue_light, float scale) {
      return b.material({.albedo = {0.5f, 0.5f, 0.5f},
                         .second = {0.4f, 0.4f, 0.4f},
                         .pattern = Pattern::kGrain,
                         .scale = scale,
                         .emission = {red, green, blue_light},
                         .group = kShowcaseLight});
    };
    glow = {panel(0.29f, 0.85f, 0.80f, 1.1f), panel(0.20f, 0.55f, 0.52f, 1.4f),
            panel(0.15f, 0.26f, 0.255f, 1.7f), panel(0.25f, 0.70f, 0.66f, 0.9f),
            panel(0.09f, 0.14f, 0.14f, 2.0f)};
    things = {b.matt({0.60f, 0.58f, 0.50f}),
              b.matt({0.10f, 0.10f, 0.11f}),
              b.matt({0.33f, 0.30f, 0.24f}),
              b.matt({0.46f, 0.40f, 0.16f}),
              b.matt({0.30f, 0.33f, 0.34f}),
              b.matt({0.22f, 0.28f, 0.20f}),
              b.matt({0.45f, 0.45f, 0.45f}, Pattern::kBlocks, {0.08f, 0.08f, 0.09f}, 14.0),
              b.matt({0.04f, 0.04f, 0.05f}),
              b.matt({0.62f, 0.62f, 0.60f}),
              b.matt({0.30f, 0.17f, 0.11f})};
    woods = {b.matt({0.34f, 0.24f, 0.14f}, Pattern::kPlanks, {0.26f, 0.18f, 0.11f}, 8.0),
             b.matt({0.22f, 0.14f, 0.09f}, Pattern::kPlanks, {0.16f, 0.10f, 0.07f}, 9.0),
             b.matt({0.44f, 0.38f, 0.28f}, Pattern::kGrain, {0.36f, 0.31f, 0.23f}, 6.0)};
    posters = {b.matt({0.55f, 0.55f, 0.50f}, Pattern::kBlocks, {0.18f, 0.22f, 0.25f}, 7.0),
               b.matt({0.30f, 0.19f, 0.16f}, Pattern::kBlocks, {0.45f, 0.43f, 0.38f}, 5.0),
               b.matt({0.07f, 0.26f, 0.15f}, Pattern::kBlocks, {0.40f, 0.42f, 0.38f}, 4.0),
               b.matt({0.08f, 0.09f, 0.11f}, Pattern::kBlocks, {0.30f, 0.32f, 0.33f}, 9.0)};
  }

  template <class List>
  int any_of(const List& list) {
    return list[static_cast<std::size_t>(random.uniform() * static_cast<double>(list.size()))];
  }

  Stream random{1, "showroom"};
  int floor, wall, ceiling, beam, pipe, column, blue, shelf, frame, lamp, strip, spot;
  std::array<int, 5> glow{};
  std::array<int, 10> things{};
  std::array<int, 3> woods{};
  std::array<int, 4> posters{};
};

/// Small boxes standing on a surface at height `base` between two corners of a frame.
void small_things(SceneBuilder& b, Palette& p, const FloorFrame& frame, const Eigen::Vector2d& low,
                  const Eigen::Vector2d& high, double base, double tallest, int count) {
  for (int i = 0; i < count; ++i) {
    const double width = p.random.uniform(0.03, 0.2), depth = p.random.uniform(0.03, 0.16);
    const Eigen::Vector2d room = (high - low - Eigen::Vector2d{width, depth}).cwiseMax(0.0);
    const double a = low.x() + p.random.uniform() * room.x(),
                 c = low.y() + p.random.uniform() * room.y();
    const double shape = p.random.uniform(), height = (0.15 + 0.85 * shape * shape) * tallest;
    b.box(frame, {a, c, base + 0.001},
          {std::min(a + width, high.x()), std::min(c + depth, high.y()), base + height},
          p.any_of(p.things));
  }
}

/// One glazed side of a showcase: sections of luminous back wall, shelves, things, light strip.
///
/// In the frame given, a runs along the side, b from the luminous wall (0) to the glass (depth).
void showcase_side(SceneBuilder& b, Palette& p, const FloorFrame& frame, double half, double depth,
                   double top) {
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
    small_things(b, p, frame, {a0 + 0.05, 0.05}, {a1 - 0.05, depth - 0.05}, 0.12, 0.5, 9);
    small_things(b, p, frame, {a0 + 0.05, 0.05}, {a1 - 0.05, depth - 0.05}, shelf + 0.05, 0.6, 11);
    small_things(b, p, frame, {a0 + 0.05, 0.5 * depth}, {a1 - 0.05, 0.6 * depth}, shelf + 0.57, 0.3,
                 4);
    // Glass shelf half way up, seen as its edge.
    b.box(frame, {a0, depth * 0.55, shelf + 0.55}, {a1, depth * 0.6, shelf + 0.57}, p.things[8]);
    b.box(frame, {a0 - 0.02, depth - 0.04, 0.1}, {a0 + 0.02, depth, top}, p.frame);
  }
  b.box(frame, {-half, 0.02, shelf}, {half, depth - 0.01, shelf + 0.05}, p.shelf);
  const Eigen::Vector3d corner = frame.at(-half + 0.05, depth - 0.005, top - 0.13);
  b.rectangle(corner, frame.at(half - 0.05, depth - 0.005, top - 0.13) - corner, {0, 0, -0.06},
              frame.at(0, 1, 0) - frame.at(0, 0, 0), p.strip);
}

/// A back-lit showcase with dark-blue ends, open to both long sides.
void add_showcase(SceneBuilder& b, Palette& p, const WorldBox& box) {
  const bool turned = box.size.x() < box.size.y();
  const double along = (turned ? box.size.y() : box.size.x()) / 2;
  const double depth = (turned ? box.size.x() : box.size.y()) / 2;
  const double heading = box.heading + (turned ? kPi / 2 : 0.0);
  const FloorFrame frame{.origin = box.center, .heading = heading};
  b.box(frame, {-along, -depth, 0}, {along, depth, 0.12}, p.frame);
  b.box(frame, {-along, -depth, box.top - 0.07}, {along, depth, box.top}, p.frame);
  for (const double end : {-along, along - 0.06})
    b.box(frame, {end, -depth, 0.12}, {end + 0.06, depth, box.top - 0.07}, p.blue);
  showcase_side(b, p, frame, along - 0.06, depth, box.top);
  const FloorFrame back{.origin = box.center, .heading = heading + kPi};
  showcase_side(b, p, back, along - 0.06, depth, box.top);
}

/// A table with legs, a shelf of stored things below and more on top; nothing above `top`.
void add_table(SceneBuilder& b, Palette& p, const WorldBox& box) {
  const FloorFrame frame{.origin = box.center, .heading = box.heading};
  const double a = box.size.x() / 2, c = box.size.y() / 2;
  const double clutter = std::min(0.3, 0.35 * box.top), plate = box.top - clutter;
  b.box(frame, {-a, -c, plate - 0.04}, {a, c, plate},
        p.random.uniform() < 0.5 ? p.any_of(p.woods) : p.things[8]);
  for (const double x : {-a + 0.02, a - 0.06})
    for (const double y : {-c + 0.02, c - 0.06})
      b.box(frame, {x, y, 0}, {x + 0.04, y + 0.04, plate}, p.frame);
  const int count = static_cast<int>(4 + 5 * a * c * 4);
  small_things(b, p, frame, {-a, -c}, {a, c}, plate, clutter, count);
  small_things(b, p, frame, {-a + 0.1, -c + 0.1}, {a - 0.1, c - 0.1}, 0.0, plate - 0.1, count / 2);
}

/// A chair that faces away from the wall, at most 0.38 m deep.
void add_chair(SceneBuilder& b, Palette& p, const FloorFrame& wall, double a) {
  const int seat = p.any_of(p.woods), legs = p.frame;
  b.box(wall, {a, 0.02, 0.42}, {a + 0.4, 0.38, 0.46}, seat);
  b.box(wall, {a, 0.02, 0.60}, {a + 0.4, 0.05, 0.90}, seat);
  for (const double x : {a, a + 0.37})
    for (const double y : {0.02, 0.35})
      b.box(wall, {x, y, 0}, {x + 0.03, y + 0.03, y < 0.1 ? 0.9 : 0.42}, legs);
}

/// A rack of boards with things on them.
void add_rack(SceneBuilder& b, Palette& p, const FloorFrame& wall, double a, double width) {
  for (const double x : {a, a + width - 0.03})
    b.box(wall, {x, 0.02, 0}, {x + 0.03, 0.38, 2.0}, p.frame);
  for (double h = 0.3; h < 2.0; h += 0.42) {
    b.box(wall, {a, 0.02, h}, {a + width, 0.38, h + 0.03}, p.any_of(p.woods));
    small_things(b, p, wall, {a + 0.04, 0.03}, {a + width - 0.04, 0.37}, h + 0.03, 0.36, 5);
  }
}

/// A framed picture high on the wall, in front of what stands there; the frame may be reddish wood.
void add_picture(SceneBuilder& b, Palette& p, const FloorFrame& wall, double a, double width) {
  const double low = p.random.uniform(1.3, 1.7), high = low + p.random.uniform(0.4, 0.8);
  b.box(wall, {a, 0.37, low}, {a + width, 0.38, high}, p.any_of(p.woods));
  b.box(wall, {a + 0.04, 0.38, low + 0.04}, {a + width - 0.04, 0.385, high - 0.04},
        p.any_of(p.posters));
}

/// Chairs, racks, posters, boards along one wall; `wall` has a along it, b into the room.
void dress_wall(SceneBuilder& b, Palette& p, const FloorFrame& wall, double length) {
  for (double a = 0.5; a < length - 1.8;) {
    const double width = p.random.uniform(0.8, 1.6), kind = p.random.uniform();
    if (kind < 0.22) {
      add_rack(b, p, wall, a, width);
    } else if (kind < 0.38) {
      add_chair(b, p, wall, a + 0.1);
      b.box(wall, {a, 0.0, 1.2}, {a + width, 0.03, 2.1}, p.any_of(p.posters));
    } else if (kind < 0.55) {
      b.box(wall, {a, 0.0, 0.7}, {a + width, 0.04, 2.2}, p.any_of(p.posters));
    } else if (kind < 0.68) {
      b.box(wall, {a, 0.0, 0.0}, {a + width, 0.36, p.random.uniform(0.8, 2.1)}, p.blue);
    } else if (kind < 0.8) {
      const double height = p.random.uniform(0.6, 1.1);
      b.box(wall, {a, 0.0, 0.0}, {a + width, 0.38, height}, p.any_of(p.woods));
      small_things(b, p, wall, {a, 0.02}, {a + width, 0.36}, height, 0.5, 6);
    } else if (kind < 0.9) {
      const Eigen::Vector3d corner = wall.at(a, 0.05, 0.5);
      b.rectangle(corner, wall.at(a + width, 0.05, 0.5) - corner, {0, 0, -1.5},
                  wall.at(a, 1, 0.5) - corner, p.any_of(p.glow));
      b.box(wall, {a - 0.05, 0.0, 0.4}, {a + width + 0.05, 0.04, 2.1}, p.frame);
    } else {
      b.pole({.origin = wall.at(a + 0.3, 0.15, 0).head<2>()}, 0.14, 0.0, 2.9, p.pipe);
    }
    if (kind > 0.38 && kind < 0.9) add_picture(b, p, wall, a + 0.1, 0.5 * width);
    a += width + p.random.uniform(0.0, 0.35);
  }
}

/// Beams across, pipes along, lamps in rows, a few spots; all above 2.6 m.
void dress_ceiling(SceneBuilder& b, Palette& p, const World& world) {
  const FloorFrame frame{.origin = world.room_center};
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2, top = world.room_size.z();
  if (top < 2.9) return;
  for (double a = -x + 1.2; a < x; a += 2.4)
    b.box(frame, {a, -y, top - 0.28}, {a + 0.2, y, top - 0.001}, p.beam);
  for (double c = -y + 0.8; c < y; c += 3.1) {
    const double low = p.random.uniform(2.65, 2.8), width = p.random.uniform(0.06, 0.16);
    b.box(frame, {-x, c, low}, {x, c + width, low + width},
          p.random.uniform() < 0.5 ? p.pipe : p.beam);
    b.box(frame, {-x, c + 0.35, top - 0.4}, {x, c + 0.42, top - 0.33}, p.pipe);
  }
  for (double a = -x + 1.6; a < x - 0.5; a += 2.4) {
    for (double c = -y + 1.5; c < y - 1.5; c += 1.9) {
      const double da = p.random.uniform(-0.3, 0.3), dc = p.random.uniform(-0.8, 0.8);
      if (p.random.uniform() < 0.1) continue;
      const bool across = p.random.uniform() < 0.5;
      const double wa = across ? 0.14 : 1.3, wc = across ? 1.3 : 0.14, h = top - 0.33;
      b.box(frame, {a + da, c + dc, h + 0.005}, {a + da + wa, c + dc + wc, h + 0.06}, p.pipe);
      const Eigen::Vector3d corner = frame.at(a + da, c + dc, h);
      b.rectangle(corner, {wa, 0, 0}, {0, wc, 0}, {0, 0, 1}, p.lamp);
      const Eigen::Vector3d spot = frame.at(a + da - 0.5, c + dc + 0.4, 2.7);
      b.rectangle(spot, {0.08, 0, 0}, {0, 0.08, 0}, {0, 0, 1}, p.spot);
      b.box(frame, {a + da - 0.5, c + dc + 0.4, 2.705}, {a + da - 0.42, c + dc + 0.48, 2.85},
            p.things[8]);
    }
  }
}

void dress_obstacle(SceneBuilder& b, Palette& p, const WorldBox& box, double ceiling) {
  const double longest = box.size.maxCoeff(), area = box.size.prod();
  const FloorFrame frame{.origin = box.center, .heading = box.heading};
  const double a = box.size.x() / 2, c = box.size.y() / 2;
  if (box.pole || box.bottom > 0.0) return b.solid_box(box, box.pole ? p.pipe : p.beam);
  if (longest <= 0.45)
    return b.box(frame, {-a, -c, 0}, {a, c, box.top > 1.9 ? ceiling : box.top}, p.column);
  if (box.top >= 1.5 && area >= 1.5 && box.size.minCoeff() > 0.5) return add_showcase(b, p, box);
  if (box.top >= 1.5) return b.box(frame, {-a, -c, 0}, {a, c, box.top}, p.blue);
  add_table(b, p, box);
}

}  // namespace

void dress_showroom(SceneBuilder& b, const World& world) {
  Palette p{b};
  const FloorFrame room{.origin = world.room_center};
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2, top = world.room_size.z();
  b.rectangle(room.at(-x, -y, 0), {2 * x, 0, 0}, {0, 2 * y, 0}, {0, 0, -1}, p.floor);
  b.rectangle(room.at(-x, -y, top), {2 * x, 0, 0}, {0, 2 * y, 0}, {0, 0, 1}, p.ceiling);
  for (int side = 0; side < 4; ++side) {
    const bool long_x = side % 2 == 0;
    const double depth = long_x ? y : x, length = 2 * (long_x ? x : y), heading = side * kPi / 2;
    const FloorFrame turned{.origin = world.room_center, .heading = heading};
    const FloorFrame wall{.origin = turned.at(-length / 2, -depth, 0).head<2>(),
                          .heading = heading};
    const Eigen::Vector3d corner = wall.at(0, 0, 0);
    b.rectangle(corner, wall.at(length, 0, 0) - corner, {0, 0, -top}, wall.at(0, 1, 0) - corner,
                p.wall);
    dress_wall(b, p, wall, length);
  }
  dress_ceiling(b, p, world);
  for (const WorldBox& box : world.obstacles) dress_obstacle(b, p, box, top);
}

}  // namespace gatefly::sim
