// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/scene.hpp"
#include "gatefly/sim/scene_aviation.hpp"
#include "gatefly/sim/scene_figure.hpp"
#include "gatefly/sim/showroom_palette.hpp"

namespace gatefly::sim {
namespace {

using Palette = ShowroomPalette;

/// A chair that faces away from the wall, at most 0.38 m deep.
void add_chair(SceneBuilder& b, Palette& p, const FloorFrame& wall, double a) {
  const int seat = p.chance(0.3) ? p.any_of(p.warm) : p.any_of(p.woods), legs = p.frame;
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
    add_small_things(b, p, wall, {a + 0.04, 0.03}, {a + width - 0.04, 0.37}, h + 0.03, 0.36, 9);
  }
}

/// A framed picture high on the wall, in front of what stands there; the frame may be reddish wood.
void add_picture(SceneBuilder& b, Palette& p, const FloorFrame& wall, double a, double width) {
  const double low = p.random.uniform(1.3, 1.7), high = low + p.random.uniform(0.4, 0.8);
  b.box(wall, {a, 0.37, low}, {a + width, 0.38, high},
        p.chance(0.3) ? p.any_of(p.warm) : p.any_of(p.woods));
  b.box(wall, {a + 0.04, 0.38, low + 0.04}, {a + width - 0.04, 0.385, high - 0.04},
        p.any_of(p.posters));
}

/// A door in its frame, an exit sign above it, a fire extinguisher and its sign beside it.
void add_door(SceneBuilder& b, Palette& p, const FloorFrame& wall, double a, double width) {
  const int leaf = p.chance(0.5) ? p.any_of(p.warm) : p.any_of(p.woods);
  b.box(wall, {a, 0.0, 0.0}, {a + width, 0.06, 2.2}, p.frame);
  b.box(wall, {a + 0.08, 0.06, 0.0}, {a + width - 0.08, 0.08, 2.12}, leaf);
  b.box(wall, {a + 0.25, 0.08, 1.2}, {a + width - 0.25, 0.085, 1.8}, p.glass);
  const Eigen::Vector3d sign = wall.at(a + 0.2, 0.12, 2.28);
  b.box(wall, {a + 0.18, 0.02, 2.26}, {a + 0.57, 0.119, 2.45}, p.frame);
  b.rectangle(sign, wall.at(a + 0.55, 0.12, 2.28) - sign, {0, 0, -0.15},
              wall.at(0, 1, 0) - wall.at(0, 0, 0), p.exit_sign);
  const double x = a + width + 0.1;
  b.pole({.origin = wall.at(x, 0.14, 0).head<2>()}, 0.16, 0.35, 0.95, p.warm[1]);
  b.box(wall, {x - 0.1, 0.0, 1.3}, {x + 0.1, 0.01, 1.5}, p.warm[1]);
}

void add_cartons(SceneBuilder& b, Palette& p, const FloorFrame& wall, double a, double width) {
  for (double x = a; x < a + width - 0.35; x += 0.4) {
    double h = 0.0;
    for (int level = static_cast<int>(p.random.uniform(1, 5)); level > 0; --level) {
      const double high = h + p.random.uniform(0.2, 0.4);
      b.box(wall, {x, 0.03, h}, {x + p.random.uniform(0.25, 0.38), 0.38, high - 0.005},
            p.chance(0.7) ? p.carton : p.any_of(p.warm));
      h = high;
    }
  }
}

/// A back-lit case against the wall, with exhibits behind glass.
void add_wall_case(SceneBuilder& b, Palette& p, const FloorFrame& wall, double a, double width) {
  const double top = p.random.uniform(1.9, 2.3), half = 0.5 * width;
  const FloorFrame middle{.origin = wall.at(a + half, 0.0, 0).head<2>(), .heading = wall.heading};
  b.box(middle, {-half, 0.0, 0.0}, {half, 0.38, 0.12}, p.frame);
  b.box(middle, {-half, 0.0, top - 0.07}, {half, 0.38, top}, p.frame);
  for (const double end : {-half, half - 0.05})
    b.box(middle, {end, 0.0, 0.12}, {end + 0.05, 0.38, top - 0.07}, p.blue);
  add_showcase_side(b, p, middle, half - 0.05, 0.38, top);
}

/// Somebody who stands and looks at the exhibits.
void add_visitor(SceneBuilder& b, Palette& p, const FloorFrame& wall, double a) {
  const FloorFrame at{.origin = wall.at(a + 0.4, 0.22, 0).head<2>(),
                      .heading = wall.heading + (p.chance(0.5) ? 0.5 : -0.5) * kPi};
  add_figure(b, at,
             {.height = p.random.uniform(1.6, 1.9),
              .skin = p.warm[2],
              .hair = p.fabrics[1],
              .shirt = p.chance(0.3) ? p.any_of(p.warm) : p.any_of(p.fabrics),
              .trousers = p.fabrics[0]});
}

void add_cupboard(SceneBuilder& b, Palette& p, const FloorFrame& wall, double a, double width) {
  const double height = p.random.uniform(0.6, 1.1);
  b.box(wall, {a, 0.0, 0.0}, {a + width, 0.38, height}, p.any_of(p.woods));
  add_small_things(b, p, wall, {a, 0.02}, {a + width, 0.36}, height, 0.5, 10);
}

/// Pipes, trunking, shelves with cartons, boards: what is on a wall above the heads.
void dress_upper_wall(SceneBuilder& b, Palette& p, const FloorFrame& wall, double length) {
  for (double h = 2.3; h < 2.56; h += 0.13)
    b.bar(wall.at(0.05, 0.1, h), wall.at(length - 0.05, 0.1, h), p.random.uniform(0.03, 0.09),
          p.chance(0.3)   ? p.any_of(p.warm)
          : p.chance(0.5) ? p.pipe
                          : p.beam);
  for (double a = 0.6; a < length - 1.0; a += p.random.uniform(0.7, 1.6)) {
    const double kind = p.random.uniform();
    if (kind < 0.35) {
      b.box(wall, {a, 0.0, 2.28}, {a + 0.6, 0.34, 2.32}, p.any_of(p.woods));
      add_small_things(b, p, wall, {a, 0.16}, {a + 0.6, 0.34}, 2.32, 0.28, 4);
    } else if (kind < 0.6) {
      b.box(wall, {a, 0.0, 1.9}, {a + 0.3, 0.16, 2.5}, p.any_of(p.things));
    } else if (kind < 0.8) {
      b.box(wall, {a, 0.0, 1.75}, {a + 0.7, 0.02, 2.25}, p.any_of(p.posters));
    }
  }
}

}  // namespace

void add_small_things(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& frame,
                      const Eigen::Vector2d& low, const Eigen::Vector2d& high, double base,
                      double tallest, int count) {
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

void dress_showroom_wall(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& wall,
                         double length) {
  dress_upper_wall(b, p, wall, length);
  for (double a = 0.5; a < length - 2.0;) {
    const double width = p.random.uniform(0.8, 1.6), kind = p.random.uniform();
    if (kind < 0.10)
      add_rack(b, p, wall, a, width);
    else if (kind < 0.20)
      add_wall_case(b, p, wall, a, width);
    else if (kind < 0.30)
      add_leaning_wings(b, p, wall, a, width);
    else if (kind < 0.38)
      add_rib_frame(b, p, wall, a, width);
    else if (kind < 0.47)
      add_fuselage_panel(b, p, wall, a, width);
    else if (kind < 0.54)
      add_seats(b, p, wall, a, width);
    else if (kind < 0.60)
      add_engine(b, p, wall, a);
    else if (kind < 0.66)
      add_wheel(b, p, wall, a);
    else if (kind < 0.72)
      add_cartons(b, p, wall, a, width);
    else if (kind < 0.78)
      add_door(b, p, wall, a, 1.0);
    else if (kind < 0.83)
      add_visitor(b, p, wall, a);
    else if (kind < 0.88)
      add_cupboard(b, p, wall, a, width);
    else if (kind < 0.93)
      b.box(wall, {a, 0.0, 0.0}, {a + width, 0.36, p.random.uniform(0.8, 2.1)}, p.blue);
    else
      add_chair(b, p, wall, a + 0.1);
    if (kind > 0.47) add_picture(b, p, wall, a + 0.1, 0.5 * width);
    if (kind > 0.38 && p.chance(0.4))
      b.pole({.origin = wall.at(a, 0.05, 0).head<2>()}, 0.08, 0.0, 2.9,
             p.chance(0.3) ? p.yellow : p.pipe);
    a += std::max(width, 1.1) + p.random.uniform(0.02, 0.2);
  }
}

}  // namespace gatefly::sim
