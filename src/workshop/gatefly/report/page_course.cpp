// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/page_course.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/report/page_numbers.hpp"

namespace gatefly::report {
namespace {

using Json = nlohmann::ordered_json;

Json box(const world::WorldBox& b) {
  return {{"center", {rounded(b.center.x()), rounded(b.center.y())}},
          {"size", {rounded(b.size.x()), rounded(b.size.y())}},
          {"heading", rounded(b.heading)},
          {"bottom", rounded(b.bottom)},
          {"top", rounded(b.top)},
          {"pole", b.pole}};
}

Json way(const Path& path) {
  Json json = Json::array();
  const double length = path.length();
  const int steps = std::max(1, static_cast<int>(std::ceil(length / 0.15)));
  for (int i = 0; i <= steps; ++i) {
    const double s = length * i / steps;
    const Eigen::Vector2d at = path.at(s).position;
    json.push_back(place({at.x(), at.y(), path.z_at(s)}));
  }
  return json;
}

Json way(const RacePlan& plan) {
  Json json = Json::array({way(plan.start)});
  for (const Path& leg : plan.legs) json.push_back(way(leg));
  return json;
}

Json gates_of(const PageCourse& course) {
  Json gates = Json::array();
  for (std::size_t i = 0; i < course.world.gates.size(); ++i) {
    const world::WorldGate& gate = course.world.gates[i];
    Json json{{"position", place(gate.p_EG)},
              {"heading", rounded(gate.yaw_EG)},
              {"side", rounded(gate.side)},
              {"bar", rounded(gate.bar)}};
    if (course.is_truth && i < course.map.gates.size()) {
      const MapGate& map = course.map.gates[i];
      json["map"] = {{"position", place(map.p_EG)}, {"heading", rounded(map.yaw_EG)}};
    }
    gates.push_back(std::move(json));
  }
  return gates;
}

}  // namespace

PageCourse page_course(const PilotConfig& pilot, const world::SimConfig& sim, bool pictures) {
  return {.world = sim.world,
          .map = pilot.track,
          .speed = pilot.plan.speed,
          .pictures_per_second = pictures ? sim.sensors.camera_hz : 0.0,
          .accel_bias = sim.sensors.accel_bias + sim.sensors.flight_bias,
          .gyro_bias = sim.sensors.gyro_bias + sim.sensors.gyro_drift,
          .rotor_limits = {pilot.vehicle.min_speed, pilot.vehicle.max_speed}};
}

PageCourse page_course(const PilotConfig& pilot) {
  PageCourse course;
  course.map = pilot.track;
  course.speed = pilot.plan.speed;
  course.is_truth = false;
  course.rotor_limits = {pilot.vehicle.min_speed, pilot.vehicle.max_speed};
  const Track& map = pilot.track;
  for (const MapGate& gate : map.gates)
    course.world.gates.push_back(
        {.p_EG = gate.p_EG, .yaw_EG = gate.yaw_EG, .side = gate.side, .bar = gate.bar});
  for (const MapObstacle& box : map.obstacles)
    course.world.obstacles.push_back(
        {.center = box.center, .size = box.size, .heading = box.heading, .top = box.height});
  course.world.room_center = map.room_center;
  course.world.room_size = {map.room_size.x(), map.room_size.y(), map.ceiling};
  return course;
}

Json as_json(const PageCourse& course, const std::optional<RacePlan>& plan) {
  const world::World& world = course.world;
  Json obstacles = Json::array(), decoys = Json::array();
  for (const world::WorldBox& b : world.obstacles) obstacles.push_back(box(b));
  for (const world::Decoy& decoy : world.decoys) decoys.push_back(box(decoy.shape));
  Json json{{"room_center", {rounded(world.room_center.x()), rounded(world.room_center.y())}},
            {"room_size", place(world.room_size)},
            {"laps", course.map.laps},
            {"speed_mps", rounded(course.speed)},
            {"rotor_limits_radps", course.rotor_limits},
            {"gates", gates_of(course)},
            {"obstacles", std::move(obstacles)},
            {"decoys", std::move(decoys)},
            {"plan", plan ? way(*plan) : Json::array()}};
  if (course.accel_bias) json["accel_bias_mps2"] = place(*course.accel_bias);
  if (course.gyro_bias) {
    json["gyro_bias_radps"] = Json::array();
    for (const double bias : *course.gyro_bias)
      json["gyro_bias_radps"].push_back(rounded(bias, kHundredth));
  }
  return json;
}

double pictures_expected(const PageCourse& course, const RacePlan& plan) {
  if (course.pictures > 0) return static_cast<double>(course.pictures);
  double lap = 0.0;
  for (const Path& leg : plan.legs) lap += leg.length();
  const double way = plan.start.length() + lap * course.map.laps;
  return course.pictures_per_second * (10.0 + 1.2 * way / std::max(0.1, course.speed));
}

std::optional<Eigen::Vector3d> in_gate(const world::World& world, int gate,
                                       const Eigen::Vector3d& p_EB) {
  if (static_cast<std::size_t>(gate) >= world.gates.size()) return std::nullopt;
  const world::WorldGate& there = world.gates[static_cast<std::size_t>(gate)];
  return Eigen::Vector3d{rotation_z(-there.yaw_EG) * (p_EB - there.p_EG)};
}

}  // namespace gatefly::report
