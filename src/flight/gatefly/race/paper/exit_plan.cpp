// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/paper/exit_plan.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "gatefly/geometry/frames.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

constexpr double kSameHeading =
    5.0 * kDegree;                            // an arc that turns so nearly to the gate ends there
constexpr double kSharpest = 10.0 * kDegree;  // a smaller turn is none: it goes straight on

Eigen::Vector2d ahead(double heading) {
  const auto [sine, cosine] = sincos(heading);
  return {cosine, sine};
}

std::string name_of(std::size_t gate) { return "gate " + std::to_string(gate + 1); }

/// Straight along the axis of a gate, from beside `from` to its plane.
Segment approach_from(const Eigen::Vector2d& from, const MapGate& gate, const std::string& what) {
  const Eigen::Vector2d axis = ahead(gate.yaw_EG), center = gate.p_EG.head<2>();
  const double length = axis.dot(center - from);
  if (length <= 0.0) throw std::invalid_argument(what + " is not before the gate");
  return {.start = center - length * axis, .heading = gate.yaw_EG, .length = length};
}

Path leg(const Track& track, std::size_t from, std::size_t to) {
  const MapGate &gate = track.gates[from], &next = track.gates[to];
  if (!gate.exit)
    throw std::invalid_argument(name_of(from) +
                                " has no exit: control.mode = \"paper\" flies by exits");
  const GateExit& exit = *gate.exit;
  const double change = std::abs(wrap_angle(next.yaw_EG - gate.yaw_EG));
  if (std::abs(exit.angle) > kSharpest && change < kSharpest)
    throw std::invalid_argument(
        "the exit of " + name_of(from) +
        " turns by a full circle: its end cannot be told from its beginning");
  const double off = wrap_angle(gate.yaw_EG + exit.angle - next.yaw_EG);
  if (std::abs(off) > kSameHeading)
    throw std::invalid_argument("the exit of " + name_of(from) + " turns by " +
                                std::to_string(std::lround(off / kDegree)) + "° too much to face " +
                                name_of(to));
  Path path;
  (void)path.segments.push_back(
      {.start = gate.p_EG.head<2>(), .heading = gate.yaw_EG, .length = exit.run});
  const PathPoint turn_point = point_on(path.segments[0], exit.run);
  if (std::abs(exit.angle) >= kSharpest)
    (void)path.segments.push_back({.start = turn_point.position,
                                   .heading = turn_point.heading,
                                   .curvature = std::copysign(1.0 / exit.radius, exit.angle),
                                   .length = exit.radius * std::abs(exit.angle)});
  const Segment& last = path.segments.back();
  (void)path.segments.push_back(
      approach_from(point_on(last, last.length).position, next,
                    "the arc behind " + name_of(from) + ", before " + name_of(to) + ","));
  path.climb(gate.p_EG.z(), next.p_EG.z());
  return path;
}

}  // namespace

RacePlan plan_from_exits(const Track& track) {
  if (track.gates.empty())
    throw std::invalid_argument("the track has no gates: PilotConfig::track.gates is empty");
  RacePlan plan;
  (void)plan.start.segments.push_back(
      approach_from(track.start, track.gates[0], "the start, before gate 1,"));
  (void)plan.start.levels.push_back({0.0, track.gates[0].p_EG.z()});
  const std::size_t count = track.gates.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (i + 1 == count && track.laps == 1) break;  // the last gate of a single lap leads nowhere
    plan.legs.push_back(leg(track, i, (i + 1) % count));
  }
  return plan;
}

}  // namespace gatefly
