// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/scene.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/gate_pole.hpp"
#include "gatefly/sim/people.hpp"
#include "gatefly/sim/scene_figure.hpp"

namespace gatefly::sim {
namespace {

constexpr double kNodeSpacing = 0.25;  // of the light map [m]
constexpr int kMostNodes = 2'500'000;  // 0.4 GB, minutes to bake
constexpr double kFlatBelow = 0.35;    // longest edge that one value of light serves [m]
constexpr Color kPoleColor{0.34f, 0.13f, 0.09f};
constexpr Color kFootColor{0.06f, 0.06f, 0.065f};
constexpr Color kSkinColor{0.42f, 0.26f, 0.19f};
constexpr Color kHairColor{0.05f, 0.04f, 0.035f};

/// FNV-1a over 32-bit words.
class Hash {
 public:
  void add(std::uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8)
      value_ = (value_ ^ ((word >> shift) & 0xffu)) * 0x100000001b3ull;
  }
  void add(float x) { add(std::bit_cast<std::uint32_t>(x)); }
  void add(const Color& c) {
    for (const float x : c) add(x);
  }
  void add(const Eigen::Vector3f& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ull;
};

Color to_color(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

int cells(double length) {
  return std::max(1, static_cast<int>(std::lround(length / kNodeSpacing)));
}

/// The bars' colour: worn unevenly along them.
int painted(SceneBuilder& builder, const world::WorldGate& gate, const world::GatePaint& paint) {
  constexpr double kCells = 12.0;  // of wear on a metre
  Color fresh = to_color(gate.color), worn = fresh;
  fresh[2] *= static_cast<float>(paint.blue);
  for (std::size_t c = 0; c < 3; ++c) worn[c] = static_cast<float>(1.0 - paint.wear) * fresh[c];
  return builder.matt(fresh, Pattern::kGrain, worn, kCells);
}

/// Materials of a gate.
struct GateMaterials {
  int bars = 0, pole = 0, foot = 0;
};

/// Four bars, of which that part of their width is coloured; pole and foot plate.
void add_gate(SceneBuilder& builder, const world::WorldGate& gate, const GatePole& pole,
              double width, const GateMaterials& material) {
  const FloorFrame frame{.origin = gate.p_EG.head<2>(), .heading = gate.yaw_EG};
  const double height = -gate.p_EG.z(), half = gate.side / 2, in = half - width * gate.bar,
               d = gate.depth / 2;
  builder.bars(true);
  builder.box(frame, {-d, -half, height + in}, {d, half, height + half}, material.bars);
  builder.box(frame, {-d, -half, height - half}, {d, half, height - in}, material.bars);
  builder.box(frame, {-d, -half, height - in}, {d, -in, height + in}, material.bars);
  builder.box(frame, {-d, in, height - in}, {d, half, height + in}, material.bars);
  builder.bars(false);
  if (pole.length() < 0.05) return;
  builder.box(frame, {-0.012, -0.012, pole.bottom}, {0.012, 0.012, pole.top}, material.pole);
  if (pole.on_floor()) builder.box(frame, {-0.15, -0.15, 0.0}, {0.15, 0.15, 0.05}, material.foot);
}

using Dresser = void (*)(SceneBuilder&, const world::World&);

Dresser dresser(const std::string& look) {
  static const std::map<std::string, Dresser> all{{"hall", dress_hall},
                                                  {"showroom", dress_showroom},
                                                  {"dark_hall", dress_dark_hall},
                                                  {"exhibition", dress_exhibition}};
  const auto found = all.find(look);
  if (found == all.end()) throw std::invalid_argument("no look is called \"" + look + "\"");
  return found->second;
}

/// People, in the middle of their stretches.
void add_walkers(SceneBuilder& builder, const world::World& world) {
  for (const world::Person& person : world.people) {
    const Eigen::Vector2d way = person.to - person.from;
    const FloorFrame at{.origin = 0.5 * (person.from + person.to),
                        .heading = atan2(way.y(), way.x())};
    add_figure(builder, at,
               {.height = person.height,
                .skin = builder.matt(kSkinColor),
                .hair = builder.matt(kHairColor),
                .shirt = builder.matt(to_color(person.shirt)),
                .trousers = builder.matt(to_color(person.trousers))},
               0.15);
  }
}

void add_solids(SceneBuilder& builder, const world::World& world) {
  const FloorFrame frame{.origin = world.room_center};
  const double a = world.room_size.x() / 2, b = world.room_size.y() / 2, top = world.room_size.z();
  const auto wall = [&](double a0, double b0, double a1, double b1) {
    const Eigen::Vector3d corner = frame.at(a0, b0, 0.0), inside = frame.at(0, 0, top / 2);
    builder.rectangle(corner, frame.at(a1, b1, 0) - corner, {0, 0, -top}, inside - corner, 0);
  };
  wall(-a, -b, a, -b);
  wall(-a, b, a, b);
  wall(-a, -b, -a, b);
  wall(a, -b, a, b);
  for (const double h : {0.0, top})
    builder.rectangle(frame.at(-a, -b, h), {2 * a, 0, 0}, {0, 2 * b, 0}, {0, 0, h > 0 ? 1.0 : -1.0},
                      0);
  for (const world::WorldBox& obstacle : world.obstacles) builder.solid_box(obstacle, 0);
}

}  // namespace

int Scene::nodes(const std::vector<Rectangle>& rectangles) {
  return rectangles.empty() ? 0 : rectangles.back().first_node + rectangles.back().nodes();
}

std::vector<Rectangle> Scene::walkers_at(double t) const {
  std::size_t count = 0;
  for (const Walker& walker : walkers) count += walker.rectangles;
  std::vector<Rectangle> all{moved.end() - static_cast<std::ptrdiff_t>(count), moved.end()};
  auto next = all.begin();
  for (const auto& [person, rectangles] : walkers) {
    const Eigen::Vector2d shift = place_of(person, t) - 0.5 * (person.from + person.to);
    for (std::size_t i = 0; i < rectangles; ++i, ++next)
      next->corner.head<2>() += shift.cast<float>();
  }
  return all;
}

std::uint64_t Scene::fixed_hash() const {
  Hash hash;
  for (const Rectangle& r : fixed) {
    hash.add(r.corner);
    hash.add(r.edge_u);
    hash.add(r.edge_v);
    const Material& m = materials[static_cast<std::size_t>(r.material)];
    hash.add(m.albedo);
    hash.add(m.second);
    hash.add(m.emission);
    hash.add(static_cast<std::uint32_t>(m.group));
    hash.add(static_cast<std::uint32_t>(m.pattern));
  }
  return hash.value();
}

Eigen::Vector3d FloorFrame::at(double a, double b, double h) const {
  const SinCos s = sincos(heading);
  return {origin.x() + a * s.cos - b * s.sin, origin.y() + a * s.sin + b * s.cos, -h};
}

RoomWall wall_of(const world::World& world, int side) {
  const double x = world.room_size.x() / 2, y = world.room_size.y() / 2;
  const bool long_x = side % 2 == 0;
  const double depth = long_x ? y : x, length = 2 * (long_x ? x : y), heading = side * kPi / 2;
  const FloorFrame turned{.origin = world.room_center, .heading = heading};
  return {{.origin = turned.at(-length / 2, -depth, 0).head<2>(), .heading = heading}, length};
}

int SceneBuilder::material(const Material& material) {
  scene_.materials.push_back(material);
  return static_cast<int>(scene_.materials.size()) - 1;
}

int SceneBuilder::matt(const Color& albedo, Pattern pattern, const Color& second, double scale) {
  return material({.albedo = albedo,
                   .second = pattern == Pattern::kPlain ? albedo : second,
                   .pattern = pattern,
                   .scale = static_cast<float>(scale)});
}

int SceneBuilder::light(const Color& emission, int group) {
  return material({.albedo = {0.6f, 0.6f, 0.6f},
                   .second = {0.6f, 0.6f, 0.6f},
                   .emission = emission,
                   .group = group});
}

void SceneBuilder::rectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                             const Eigen::Vector3d& v, const Eigen::Vector3d& towards,
                             int material) {
  std::vector<Rectangle>& list = layer_ == Layer::kFixed   ? scene_.fixed
                                 : layer_ == Layer::kMoved ? scene_.moved
                                                           : scene_.solid;
  const bool swap = u.cross(v).dot(towards) < 0.0;
  const Eigen::Vector3d& first = swap ? v : u;
  const Eigen::Vector3d& second = swap ? u : v;
  Rectangle r;
  r.corner = corner.cast<float>();
  r.edge_u = first.cast<float>();
  r.edge_v = second.cast<float>();
  r.normal = first.cross(second).normalized().cast<float>();
  r.length = Eigen::Vector2d{first.norm(), second.norm()}.cast<float>();
  r.material = material;
  r.first_node = Scene::nodes(list);
  r.cells_u = cells(first.norm());
  r.cells_v = cells(second.norm());
  if (r.nodes() > kMostNodes - r.first_node)
    throw std::length_error(
        "the room is too large for pictures: its light map would have more than " +
        std::to_string(kMostNodes) + " points");
  r.flat = std::max(first.norm(), second.norm()) < kFlatBelow;
  r.gate = gate_;
  r.bar = bars_;
  r.closed = closed_;
  list.push_back(r);
}

void SceneBuilder::box(const FloorFrame& frame, const Eigen::Vector3d& low,
                       const Eigen::Vector3d& high, int material) {
  const Eigen::Vector3d corner = frame.at(low.x(), low.y(), low.z());
  const Eigen::Vector3d opposite = frame.at(high.x(), high.y(), high.z());
  const Eigen::Vector3d a = frame.at(high.x(), low.y(), low.z()) - corner;
  const Eigen::Vector3d b = frame.at(low.x(), high.y(), low.z()) - corner;
  const Eigen::Vector3d h{0, 0, low.z() - high.z()};
  closed_ = true;
  rectangle(corner, b, h, -a, material);
  rectangle(corner + a, b, h, a, material);
  rectangle(corner, a, h, -b, material);
  rectangle(corner + b, a, h, b, material);
  rectangle(opposite - a - b, a, b, h, material);
  if (low.z() > 0.0) rectangle(corner, a, b, -h, material);
  closed_ = false;
}

void SceneBuilder::pole(const FloorFrame& frame, double diameter, double bottom, double top,
                        int material) {
  constexpr int kSides = 8;
  const double radius = diameter / 2 / cos(kPi / kSides);
  const Eigen::Vector3d centre = frame.at(0, 0, bottom), up{0, 0, bottom - top};
  for (int i = 0; i < kSides; ++i) {
    const SinCos one = sincos(2 * kPi * i / kSides), two = sincos(2 * kPi * (i + 1) / kSides);
    const Eigen::Vector3d from = frame.at(radius * one.cos, radius * one.sin, bottom);
    const Eigen::Vector3d to = frame.at(radius * two.cos, radius * two.sin, bottom);
    rectangle(from, to - from, up, (from + to) / 2 - centre, material);
  }
  // A square lid inside the octagon is enough: nothing flies close above a pole.
  const double in = 0.35 * diameter;
  rectangle(frame.at(-in, -in, top), frame.at(in, -in, top) - frame.at(-in, -in, top),
            frame.at(-in, in, top) - frame.at(-in, -in, top), up, material);
}

void SceneBuilder::block(const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                         const Eigen::Vector3d& v, const Eigen::Vector3d& w, int material) {
  const auto pair = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& out) {
    rectangle(corner, a, b, -out, material);
    rectangle(corner + out, a, b, out, material);
  };
  pair(u, v, w);
  pair(v, w, u);
  pair(w, u, v);
}

void SceneBuilder::bar(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width,
                       int material) {
  const Eigen::Vector3d along = to - from;
  const Eigen::Vector3d a = 0.5 * width * along.unitOrthogonal();
  const Eigen::Vector3d b = 0.5 * width * along.cross(a).normalized();
  for (const auto& [side, out] : {std::pair{a, b}, std::pair{b, a}}) {
    rectangle(from + out - side, along, 2 * side, out, material);
    rectangle(from - out - side, along, 2 * side, -out, material);
  }
}

void SceneBuilder::tube(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double diameter,
                        int material) {
  constexpr int kSides = 8;
  const Eigen::Vector3d along = to - from, a = along.unitOrthogonal(),
                        b = along.cross(a).normalized();
  const double radius = diameter / 2;
  const auto rim = [&](int i) -> Eigen::Vector3d {
    const SinCos s = sincos(2 * kPi * i / kSides);
    return radius * (s.cos * a + s.sin * b);
  };
  for (int i = 0; i < kSides; ++i)
    rectangle(from + rim(i), rim(i + 1) - rim(i), along, rim(i) + rim(i + 1), material);
  // Two squares make the star of eight corners that the rim has.
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d corner = rim(i), u = rim(i + 2) - corner, v = rim(i + 6) - corner;
    rectangle(from + corner, u, v, -along, material);
    rectangle(to + corner, u, v, along, material);
  }
}

void SceneBuilder::solid_box(const world::WorldBox& shape, int material) {
  const FloorFrame frame{.origin = shape.center, .heading = shape.heading};
  const double a = shape.size.x() / 2, b = shape.size.y() / 2;
  if (shape.pole) return pole(frame, shape.size.x(), shape.bottom, shape.top, material);
  box(frame, {-a, -b, shape.bottom}, {a, b, shape.top}, material);
}

Scene make_scene(const world::World& world) {
  Scene scene;
  SceneBuilder builder{scene};
  dresser(world.look)(builder, world);

  const int pole = builder.matt(kPoleColor), foot = builder.matt(kFootColor);
  const auto movable = [&](SceneBuilder::Layer layer) {
    builder.layer(layer);
    const auto add = [&](const world::WorldGate& gate) {
      const double width =
          layer == SceneBuilder::Layer::kMoved ? world.paint.part_of(gate.bar) : 1.0;
      add_gate(builder, gate, pole_of(gate, world), width,
               {painted(builder, gate, world.paint), pole, foot});
    };
    for (std::size_t i = 0; i < world.gates.size(); ++i) {
      builder.gate(static_cast<int>(i));
      if (!world.gates[i].missing) add(world.gates[i]);
    }
    builder.gate(-1);
    for (const world::WorldGate& gate : world.false_gates) add(gate);
    for (const world::Decoy& decoy : world.decoys)
      builder.solid_box(decoy.shape, builder.matt(to_color(decoy.color)));
  };
  movable(SceneBuilder::Layer::kMoved);
  const std::size_t before = scene.moved.size();
  builder.layer(SceneBuilder::Layer::kMoved);
  add_walkers(builder, world);
  for (const world::Person& person : world.people)
    scene.walkers.push_back({person, (scene.moved.size() - before) / world.people.size()});
  movable(SceneBuilder::Layer::kSolid);
  add_solids(builder, world);
  add_walkers(builder, world);
  return scene;
}

}  // namespace gatefly::sim
