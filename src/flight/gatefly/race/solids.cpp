// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/solids.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

constexpr double kFrameDepth = 0.1;  // of a gate, along the way through it [m]
constexpr double kPole = 0.05;       // its thickness [m]
constexpr double kOwnGate = 0.8;     // so near the end of a leg its gate is flown through [m]

/// A point in a box's own axes.
Eigen::Vector2d own(const MapObstacle& box, const Eigen::Vector2d& p) {
  const auto [s, c] = sincos(box.heading);
  const Eigen::Vector2d d = p - box.center;
  return {d.dot(Eigen::Vector2d{c, s}), d.dot(Eigen::Vector2d{-s, c})};
}

std::vector<Eigen::Vector2d> corners_of(const MapObstacle& box) {
  const auto [s, c] = sincos(box.heading);
  std::vector<Eigen::Vector2d> corners;
  for (const double a : {-0.5, 0.5})
    for (const double b : {-0.5, 0.5})
      corners.emplace_back(box.center + a * box.size.x() * Eigen::Vector2d{c, s} +
                           b * box.size.y() * Eigen::Vector2d{-s, c});
  return corners;
}

/// Least distance on the floor plan between two upright things that do not touch: one of them has a
/// corner there.
double apart(const MapSolid& one, const MapSolid& other) {
  double least = 1e9;
  for (const auto& [from, to] : {std::pair{&one, &other}, std::pair{&other, &one}}) {
    if (from->kind == MapSolid::Kind::kWall) continue;
    for (const Eigen::Vector2d& corner : corners_of(from->footprint))
      least = std::min(least, to->beside(corner));
  }
  if (one.kind == MapSolid::Kind::kWall && other.kind == MapSolid::Kind::kWall)
    least = std::abs((one.foot - other.foot).dot(one.inwards));
  return std::max(0.0, least);
}

void add_walls(const Track& track, std::vector<MapSolid>& solids) {
  const Eigen::Vector2d half = 0.5 * track.room_size;
  for (const Eigen::Vector2d& out : {Eigen::Vector2d{1, 0}, Eigen::Vector2d{-1, 0},
                                     Eigen::Vector2d{0, 1}, Eigen::Vector2d{0, -1}})
    solids.push_back({.kind = MapSolid::Kind::kWall,
                      .footprint = {},
                      .bottom = -1e9,
                      .inwards = -out,
                      .foot = track.room_center + out.cwiseProduct(half)});
}

/// Height of what carries a gate's frame: of the floor, or of the frame beneath.
double carrier_of(const MapGate& gate, const Track& track) {
  const double bottom = -gate.p_EG.z() - 0.5 * gate.side;
  double carrier = 0.0;
  for (const MapGate& lower : track.gates) {
    if (-lower.p_EG.z() > bottom) continue;
    const MapObstacle frame{
        lower.p_EG.head<2>(), {lower.side, lower.side}, lower.yaw_EG, lower.side};
    const Eigen::Vector2d off = own(frame, gate.p_EG.head<2>()).cwiseAbs();
    if (off.maxCoeff() < 0.5 * lower.side)
      carrier = std::max(carrier, -lower.p_EG.z() + 0.5 * lower.side);
  }
  return carrier;
}

}  // namespace

double MapSolid::beside(const Eigen::Vector2d& p) const {
  if (kind == Kind::kFloor || kind == Kind::kCeiling) return -1e9;
  if (kind == Kind::kWall) return inwards.dot(p - foot);
  const Eigen::Vector2d off = own(footprint, p).cwiseAbs() - 0.5 * footprint.size;
  return off.maxCoeff() < 0.0 ? off.maxCoeff() : off.cwiseMax(0.0).norm();
}

double MapSolid::above_or_below(double height) const {
  return std::max(bottom - height, height - top);
}

std::string MapSolid::name() const {
  switch (kind) {
    case Kind::kWall:
      return "a wall";
    case Kind::kObstacle:
      return "obstacle " + std::to_string(number + 1);
    case Kind::kGate:
      return "gate " + std::to_string(number + 1);
    case Kind::kFloor:
      return "the floor";
    case Kind::kCeiling:
      return "the ceiling";
  }
  return "";
}

std::vector<MapSolid> solids_of(const Track& track) {
  std::vector<MapSolid> solids;
  add_walls(track, solids);
  for (std::size_t i = 0; i < track.obstacles.size(); ++i)
    solids.push_back({.kind = MapSolid::Kind::kObstacle,
                      .number = static_cast<int>(i),
                      .footprint = track.obstacles[i],
                      .bottom = -1e9,
                      .top = track.obstacles[i].height});
  for (std::size_t i = 0; i < track.gates.size(); ++i) {
    const MapGate& gate = track.gates[i];
    const double height = -gate.p_EG.z(), bottom = height - 0.5 * gate.side;
    MapSolid frame{.kind = MapSolid::Kind::kGate,
                   .number = static_cast<int>(i),
                   .footprint = {gate.p_EG.head<2>(), {kFrameDepth, gate.side}, gate.yaw_EG, 0.0},
                   .bottom = bottom,
                   .top = height + 0.5 * gate.side};
    solids.push_back(frame);
    MapSolid pole = frame;
    pole.footprint.size = {kPole, kPole};
    pole.bottom = carrier_of(gate, track), pole.top = bottom;
    if (pole.top - pole.bottom > kPole) solids.push_back(pole);
  }
  solids.push_back({.kind = MapSolid::Kind::kFloor, .footprint = {}, .bottom = -1e9, .top = 0.0});
  solids.push_back({.kind = MapSolid::Kind::kCeiling, .footprint = {}, .bottom = track.ceiling});
  return solids;
}

Gap gap_between(const MapSolid& one, const MapSolid& other, const PlanParams& params) {
  const auto rank = [](const MapSolid& solid) { return std::pair{solid.kind, solid.number}; };
  if (rank(other) < rank(one)) return gap_between(other, one, params);
  const bool walls = one.kind == MapSolid::Kind::kWall && other.kind == MapSolid::Kind::kWall;
  const std::string between =
      walls ? "between two walls" : "between " + one.name() + " and " + other.name();
  const double above = std::max(one.bottom - other.top, other.bottom - one.top);
  if (above >= 0.0) return {between, above, 2 * params.clearance};
  return {between, apart(one, other), 2 * (params.clearance + params.body_radius)};
}

Nearest nearest_solid(const std::vector<MapSolid>& solids, const PlanParams& params,
                      const Path& path, int from_gate, int to_gate, double near_enough) {
  return nearest_between(solids, params, path, {0.0, path.length()}, from_gate, to_gate,
                         near_enough);
}

Nearest nearest_between(const std::vector<MapSolid>& solids, const PlanParams& params,
                        const Path& path, const Stretch& stretch, int from_gate, int to_gate,
                        double near_enough) {
  constexpr double kStep = 0.1;  // [m]
  const double total = path.length();
  Nearest nearest;
  for (double s = stretch.from; s <= stretch.to && nearest.distance >= near_enough; s += kStep) {
    const Eigen::Vector2d p = path.at(s).position;
    const double height = -path.z_at(s);
    for (const MapSolid& solid : solids) {
      // Between the heights of two gates there is neither floor nor ceiling.
      const bool level =
          solid.kind == MapSolid::Kind::kFloor || solid.kind == MapSolid::Kind::kCeiling;
      if (level || solid.above_or_below(height) >= params.clearance) continue;
      const bool gate = solid.kind == MapSolid::Kind::kGate;
      if (gate && solid.number == from_gate && s < kOwnGate) continue;
      if (gate && solid.number == to_gate && total - s < kOwnGate) continue;
      const double distance = solid.beside(p);
      if (distance < nearest.distance) nearest = {distance, &solid};
    }
  }
  return nearest;
}

}  // namespace gatefly
