// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/scene_aviation.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {

void add_fuselage_panel(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& wall, double a,
                        double width) {
  const double low = p.random.uniform(0.1, 0.5), high = low + p.random.uniform(1.1, 1.5);
  b.box(wall, {a, 0.1, low}, {a + width, 0.34, high}, p.skin);
  const bool green = p.chance(0.5);
  if (green) b.box(wall, {a + 0.5 * width, 0.08, high}, {a + width, 0.35, high + 0.12}, p.green);
  for (double x = a + 0.15; x < a + width - 0.25; x += 0.36)
    b.box(wall, {x, 0.34, high - 0.6}, {x + 0.2, 0.345, high - 0.3}, p.frame);
  for (const double x : {a + 0.1, a + width - 0.15})
    b.box(wall, {x, 0.12, 0}, {x + 0.05, 0.3, low}, p.frame);
  if (p.chance(0.6))
    b.box(wall, {a + 0.2, 0.34, low + 0.1}, {a + 0.5, 0.346, low + 0.4}, p.any_of(p.posters));
}

void add_rib_frame(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& wall, double a,
                   double width) {
  const int wood = p.any_of(p.woods);
  const double high = p.random.uniform(1.2, 1.9);
  b.box(wall, {a, 0.05, 0}, {a + 0.03, 0.3, high}, wood);
  b.box(wall, {a + width - 0.03, 0.05, 0}, {a + width, 0.3, high}, wood);
  for (double h = 0.15; h < high; h += 0.24) {
    b.bar(wall.at(a, 0.3, h), wall.at(a + width, 0.3, h), 0.025, wood);
    b.bar(wall.at(a, 0.08, h), wall.at(a + width, 0.08, h), 0.025, wood);
  }
  for (double x = a + 0.3; x < a + width - 0.1; x += 0.3)
    b.bar(wall.at(x, 0.3, 0.02), wall.at(x, 0.3, high), 0.03, wood);
}

void add_leaning_wings(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& wall, double a,
                       double width) {
  for (double x = a; x < a + width - 0.2;) {
    const double chord = p.random.uniform(0.07, 0.26), high = p.random.uniform(1.5, 2.5);
    const double lean = p.random.uniform(0.0, 0.18);
    const int material = p.chance(0.12)  ? p.any_of(p.warm)
                         : p.chance(0.5) ? p.glass
                         : p.chance(0.4) ? p.yellow
                                         : p.any_of(p.things);
    b.block(wall.at(x, 0.32, 0.001), wall.at(x + chord, 0.30, 0.001) - wall.at(x, 0.32, 0.001),
            wall.at(x, 0.36, 0.001) - wall.at(x, 0.32, 0.001),
            wall.at(x + lean, 0.04, high) - wall.at(x, 0.32, 0), material);
    x += chord + p.random.uniform(0.02, 0.25);
  }
}

void add_engine(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& wall, double a) {
  const Eigen::Vector3d centre = wall.at(a + 0.5, 0.05, 1.0);
  const Eigen::Vector3d out = wall.at(a + 0.5, 0.35, 1.0) - centre;
  b.tube(centre, centre + out, 0.42, p.any_of(p.things));
  for (int i = 0; i < 7; ++i) {
    const SinCos s = sincos(2 * kPi * i / 7);
    const Eigen::Vector3d way = wall.at(s.cos, 0.0, s.sin) - wall.at(0, 0, 0);
    const Eigen::Vector3d root = centre + 0.6 * out + 0.2 * way;
    b.bar(root, root + 0.25 * way, 0.12, i % 2 == 0 ? p.things[1] : p.things[8]);
    b.bar(centre + 0.95 * out + 0.1 * way, root + 0.2 * way, 0.025, p.yellow);
  }
  for (const double x : {a + 0.2, a + 0.8})
    b.bar(wall.at(x, 0.2, 0.0), wall.at(a + 0.5, 0.2, 0.85), 0.05, p.frame);
}

void add_wheel(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& wall, double a) {
  const double size = p.random.uniform(0.5, 0.95);
  const Eigen::Vector3d hub = wall.at(a + 0.5, 0.1, 0.5 * size + 0.002);
  const Eigen::Vector3d out = wall.at(a + 0.5, 0.35, 0.5 * size + 0.002) - hub;
  b.tube(hub, hub + out, size, p.things[7]);
  b.tube(hub + out, hub + 1.04 * out, 0.55 * size, p.silver);
  b.tube(hub + 1.04 * out, hub + 1.08 * out, 0.2 * size, p.any_of(p.warm));
}

void add_seats(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& wall, double a,
               double width) {
  const int cover = p.chance(0.3) ? p.any_of(p.warm) : p.any_of(p.fabrics);
  for (double x = a; x < a + width - 0.4; x += 0.5) {
    b.box(wall, {x, 0.02, 0.38}, {x + 0.44, 0.38, 0.5}, cover);
    b.box(wall, {x, 0.02, 0.5}, {x + 0.44, 0.14, 1.15}, cover);
    b.box(wall, {x + 0.08, 0.03, 1.15}, {x + 0.36, 0.12, 1.35}, p.fabrics[1]);
    b.box(wall, {x + 0.44, 0.05, 0.5}, {x + 0.49, 0.36, 0.66}, p.things[4]);
    for (const double y : {0.06, 0.34})
      b.bar(wall.at(x + 0.1, y, 0.0), wall.at(x + 0.34, y, 0.38), 0.025, p.silver);
  }
}

void add_hanging_aircraft(SceneBuilder& b, ShowroomPalette& p, const FloorFrame& nose, double low,
                          double top) {
  const double length = p.random.uniform(1.4, 2.4), span = p.random.uniform(1.5, 3.0);
  const double body = std::min(0.24, 0.5 * (top - low)), h = low + 0.6 * body;
  const int paint = p.chance(0.35) ? p.any_of(p.warm) : p.chance(0.6) ? p.glass : p.yellow;
  const int trim = p.chance(0.4) ? p.any_of(p.warm) : p.any_of(p.things);
  b.tube(nose.at(0, 0, h), nose.at(length, 0, h), body, paint);
  const Eigen::Vector3d origin = nose.at(0, 0, 0);
  const auto way = [&](double a, double c, double up) {
    return Eigen::Vector3d{nose.at(a, c, up) - origin};
  };
  const double chord = 0.22 * length, sweep = p.random.uniform(0.0, 0.3);
  for (const double side : {-0.5, 0.5}) {
    b.block(nose.at(0.25 * length, 0, h), way(chord, 0, 0), way(sweep, side * span, 0.06),
            way(0, 0, 0.03), paint);
    b.block(nose.at(0.25 * length + sweep, side * span, h + 0.06), way(chord, 0, 0),
            way(0.02, 0.12 * side, 0.01), way(0, 0, 0.03), trim);
    b.block(nose.at(0.88 * length, 0, h), way(0.1 * length, 0, 0), way(0.05, 0.35 * side * span, 0),
            way(0, 0, 0.02), trim);
  }
  b.block(nose.at(0.85 * length, -0.01, h), way(0.13 * length, 0, 0), way(0, 0.02, 0),
          way(0.08, 0, std::min(0.3, top - h - 0.03)), trim);
  for (const double a : {0.2, 0.8})
    b.bar(nose.at(a * length, 0, h), nose.at(a * length, 0, top), 0.008, p.frame);
}

}  // namespace gatefly::sim
