// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/mcap_scene.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/simulated_race/results/z_up.hpp"

namespace gatefly::simulated_race {
namespace {

using Json = nlohmann::ordered_json;

Json xyz(const Eigen::Vector3d& v) {
  const auto rounded = [](double value) { return std::round(1e4 * value) / 1e4; };
  return {{"x", rounded(v.x())}, {"y", rounded(v.y())}, {"z", rounded(v.z())}};
}

/// @param heading  as ours, clockwise from above.
Json pose(const Eigen::Vector3d& p_up, double heading = 0.0) {
  const Quaternion q = up(Attitude{.roll = 0.0, .pitch = 0.0, .yaw = heading});
  return {{"position", xyz(p_up)},
          {"orientation", {{"x", q.x}, {"y", q.y}, {"z", q.z}, {"w", q.w}}}};
}

Json color(double r, double g, double b, double a = 1.0) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}

enum class LineType { kStrip = 0, kLoop = 1 };

Json line(LineType type, const std::vector<Eigen::Vector3d>& points_up, double thickness,
          const Json& its_color) {
  Json points = Json::array();
  for (const Eigen::Vector3d& p : points_up) points.push_back(xyz(p));
  return {{"type", static_cast<int>(type)}, {"pose", pose({0, 0, 0})},     {"thickness", thickness},
          {"scale_invariant", false},       {"points", std::move(points)}, {"color", its_color},
          {"colors", Json::array()},        {"indices", Json::array()}};
}

Json entity(const std::string& id, std::uint64_t time) {
  Json json{{"timestamp", {{"sec", time / 1'000'000'000}, {"nsec", time % 1'000'000'000}}},
            {"frame_id", "world"},
            {"id", id},
            {"lifetime", {{"sec", 0}, {"nsec", 0}}},
            {"frame_locked", false}};
  for (const char* kind : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines",
                           "triangles", "texts", "models"})
    json[kind] = Json::array();
  return json;
}

/// Middle lines of a gate's bars.
std::vector<Eigen::Vector3d> frame_of(const Eigen::Vector3d& p_EG, double yaw, double side) {
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::Vector3d& corner : gate_corners_G(side))
    corners.push_back(up(Eigen::Vector3d{p_EG + rotation_z(yaw) * corner}));
  return corners;
}

/// sRGB of a linear albedo, about.
Json shown(const Eigen::Vector3d& albedo) {
  const auto bright = [](double value) { return std::pow(std::clamp(value, 0.0, 1.0), 1 / 2.2); };
  return color(bright(albedo.x()), bright(albedo.y()), bright(albedo.z()));
}

void add_box(Json& entity, const world::WorldBox& box, const Json& its_color) {
  const Eigen::Vector3d middle{box.center.x(), -box.center.y(), 0.5 * (box.bottom + box.top)};
  Json solid{
      {"pose", pose(middle, box.heading)},
      {"size", xyz({box.size.x(), box.pole ? box.size.x() : box.size.y(), box.top - box.bottom})}};
  if (box.pole) solid["bottom_scale"] = solid["top_scale"] = 1.0;
  solid["color"] = its_color;
  entity[box.pole ? "cylinders" : "cubes"].push_back(std::move(solid));
}

std::vector<Eigen::Vector3d> way(const RacePlan& plan) {
  std::vector<Eigen::Vector3d> points;
  const auto add = [&](const Path& path) {
    const double length = path.length();
    const int steps = std::max(1, static_cast<int>(std::ceil(length / 0.2)));
    for (int i = 0; i <= steps; ++i) {
      const double s = length * i / steps;
      const Eigen::Vector2d at = path.at(s).position;
      points.push_back(up(Eigen::Vector3d{at.x(), at.y(), path.z_at(s)}));
    }
  };
  add(plan.start);
  for (const Path& leg : plan.legs) add(leg);
  return points;
}

/// A gate where it stands, with its number above.
Json numbered(const world::WorldGate& gate, std::size_t number, std::uint64_t time) {
  Json json = entity("gate " + std::to_string(number), time);
  json["lines"].push_back(line(LineType::kLoop,
                               frame_of(gate.p_EG, gate.yaw_EG, gate.side - gate.bar), gate.bar,
                               shown(gate.color)));
  json["texts"].push_back({{"pose", pose(up(gate.p_EG) + Eigen::Vector3d{0, 0, 0.7 * gate.side})},
                           {"billboard", true},
                           {"font_size", 0.3},
                           {"scale_invariant", false},
                           {"color", color(0.5, 0.5, 0.5)},
                           {"text", std::to_string(number)}});
  return json;
}

Json mapped(const Track& map, std::uint64_t time) {
  Json json = entity("gates on the pilot's map", time);
  for (const MapGate& gate : map.gates)
    json["lines"].push_back(line(LineType::kLoop, frame_of(gate.p_EG, gate.yaw_EG, gate.side), 0.01,
                                 color(0.5, 0.5, 0.5)));
  return json;
}

Json obstacles_of(const world::World& world, std::uint64_t time) {
  Json json = entity("obstacles", time);
  for (const world::WorldBox& box : world.obstacles)
    add_box(json, box, color(0.6, 0.62, 0.65, 0.8));
  for (const world::Decoy& decoy : world.decoys) add_box(json, decoy.shape, shown(decoy.color));
  return json;
}

Json planned(const RacePlan& plan, std::uint64_t time) {
  Json json = entity("planned way", time);
  json["lines"].push_back(line(LineType::kStrip, way(plan), 0.03, color(0.3, 0.6, 0.9)));
  return json;
}

}  // namespace

Json scene_of(const world::World& world, const Track& map, const RacePlan& plan,
              std::uint64_t time) {
  Json entities = Json::array();
  for (std::size_t i = 0; i < world.gates.size(); ++i)
    entities.push_back(numbered(world.gates[i], i + 1, time));
  entities.push_back(mapped(map, time));
  entities.push_back(obstacles_of(world, time));
  entities.push_back(planned(plan, time));
  return {{"deletions", Json::array()}, {"entities", std::move(entities)}};
}

}  // namespace gatefly::simulated_race
