// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/solids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/gate_pole.hpp"

namespace gatefly::sim {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kWall = 0.2;        // thickness [m]
constexpr double kGatePole = 0.04;   // diameter [m]
constexpr double kSeenUpTo = 0.999;  // the point itself may lie on something

Solid solid_of(const std::string& name, const world::WorldBox& box) {
  return {name,
          {box.center.x(), box.center.y(), -0.5 * (box.bottom + box.top)},
          {box.size.x(), box.size.y(), box.top - box.bottom},
          box.heading,
          box.pole};
}

void add_room(std::vector<Solid>& solids, const world::World& world) {
  const Eigen::Vector2d c = world.room_center;
  const double a = world.room_size.x(), b = world.room_size.y(), h = world.room_size.z();
  const double half_x = 0.5 * a, half_y = 0.5 * b, out = 0.5 * kWall;
  solids.push_back({"north wall", {c.x() + half_x + out, c.y(), -0.5 * h}, {kWall, b, h}});
  solids.push_back({"south wall", {c.x() - half_x - out, c.y(), -0.5 * h}, {kWall, b, h}});
  solids.push_back({"east wall", {c.x(), c.y() + half_y + out, -0.5 * h}, {a, kWall, h}});
  solids.push_back({"west wall", {c.x(), c.y() - half_y - out, -0.5 * h}, {a, kWall, h}});
  solids.push_back({"ceiling", {c.x(), c.y(), -h - out}, {a, b, kWall}});
}

void add_gate(std::vector<Solid>& solids, const std::string& name, const world::WorldGate& gate,
              const world::World& world) {
  const Eigen::Matrix3d R_EG = rotation_z(gate.yaw_EG);
  const double off = 0.5 * (gate.side - gate.bar);
  const auto bar = [&](const char* which, double y, double z, double width, double height) {
    solids.push_back({name + " " + which,
                      gate.p_EG + R_EG * Eigen::Vector3d{0, y, z},
                      {gate.depth, width, height},
                      gate.yaw_EG});
  };
  bar("left bar", -off, 0, gate.bar, gate.side);
  bar("right bar", off, 0, gate.bar, gate.side);
  bar("upper bar", 0, -off, gate.side, gate.bar);
  bar("lower bar", 0, off, gate.side, gate.bar);
  const GatePole pole = pole_of(gate, world);
  if (pole.length() > 0.02)
    solids.push_back(
        solid_of(name + " pole",
                 {gate.p_EG.head<2>(), {kGatePole, kGatePole}, 0.0, pole.bottom, pole.top, true}));
}

/// Entry of a ray into a box or pole around the origin; infinity when it misses. 0 from
/// inside.
double entry(const Eigen::Vector3d& from, const Eigen::Vector3d& along, const Eigen::Vector3d& half,
             bool pole) {
  double enter = 0.0, leave = kNever;
  for (int axis = pole ? 2 : 0; axis < 3; ++axis) {
    if (along(axis) == 0.0) {
      if (std::abs(from(axis)) > half(axis)) return kNever;
      continue;
    }
    const double one = (-half(axis) - from(axis)) / along(axis),
                 two = (half(axis) - from(axis)) / along(axis);
    enter = std::max(enter, std::min(one, two));
    leave = std::min(leave, std::max(one, two));
  }
  if (pole) {
    // |from + t along|² = r² in the plane
    const double a = along.head<2>().squaredNorm(), b = from.head<2>().dot(along.head<2>());
    const double c = from.head<2>().squaredNorm() - half.x() * half.x(), root2 = b * b - a * c;
    if (root2 < 0.0 || (a == 0.0 && c > 0.0)) return kNever;
    if (a > 0.0) {
      enter = std::max(enter, (-b - std::sqrt(root2)) / a);
      leave = std::min(leave, (-b + std::sqrt(root2)) / a);
    }
  }
  return enter <= leave ? enter : kNever;
}

}  // namespace

std::vector<Solid> solids_of(const world::World& world) {
  std::vector<Solid> solids;
  add_room(solids, world);
  for (std::size_t i = 0; i < world.gates.size(); ++i)
    if (!world.gates[i].missing)
      add_gate(solids, "gate " + std::to_string(i + 1), world.gates[i], world);
  for (std::size_t i = 0; i < world.false_gates.size(); ++i)
    add_gate(solids, "false gate " + std::to_string(i + 1), world.false_gates[i], world);
  for (std::size_t i = 0; i < world.obstacles.size(); ++i)
    solids.push_back(solid_of("obstacle " + std::to_string(i + 1), world.obstacles[i]));
  for (std::size_t i = 0; i < world.decoys.size(); ++i)
    solids.push_back(solid_of("decoy " + std::to_string(i + 1), world.decoys[i].shape));
  return solids;
}

SolidSight::SolidSight(const world::World& world) {
  for (const Solid& solid : solids_of(world)) {
    const auto [s, c] = sincos(solid.heading);
    shapes_.push_back({solid.center_E, 0.5 * solid.size, c, s, solid.pole});
  }
}

bool SolidSight::occluded(const Eigen::Vector3d& from_E, const Eigen::Vector3d& to_E) const {
  const Eigen::Vector3d way = to_E - from_E;
  const double length = way.norm();
  if (!(length > 0.0)) return false;
  return range(from_E, way / length, kSeenUpTo * length) < kSeenUpTo * length;
}

double SolidSight::range(const Eigen::Vector3d& from_E, const Eigen::Vector3d& direction_E,
                         double max) const {
  double nearest = max;
  // the floor
  if (direction_E.z() > 0.0)
    nearest = std::min(nearest, std::max(0.0, -from_E.z() / direction_E.z()));
  for (const Shape& shape : shapes_) {
    const Eigen::Vector3d d = from_E - shape.center_E;
    const auto own = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d {
      return {shape.cos * v.x() + shape.sin * v.y(), -shape.sin * v.x() + shape.cos * v.y(), v.z()};
    };
    // Only what lies before the eye and near the line costs more than this.
    const double reach2 = shape.half.squaredNorm(), along = -d.dot(direction_E);
    if (d.squaredNorm() - along * along > reach2 || (along < 0.0 && along * along > reach2))
      continue;
    nearest = std::min(nearest, entry(own(d), own(direction_E), shape.half, shape.pole));
  }
  return nearest;
}

}  // namespace gatefly::sim
