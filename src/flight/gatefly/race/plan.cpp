// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "gatefly/geometry/math.hpp"
#include "gatefly/race/path.hpp"
#include "gatefly/race/solids.hpp"
#include "gatefly/race/way_round.hpp"

namespace gatefly {
namespace {

constexpr double kTakeOff = 0.9;  // so high the first leg begins, or higher [m]
constexpr double kSunk = 0.01;    // a gate that stands on the floor may be so low by rounding [m]

// Two digits after the point, without noughts at the end.
std::string short_text(double value) {
  std::string text = std::to_string(std::round(value * 100.0) / 100.0);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

struct Pose2 {
  Eigen::Vector2d position;
  double heading;
};

Eigen::Vector2d ahead(double heading) {
  const auto [s, c] = sincos(heading);
  return {c, s};
}
Eigen::Vector2d right(double heading) {
  const auto [s, c] = sincos(heading);
  return {-s, c};
}

Pose2 moved(const Pose2& pose, double distance) {
  return {pose.position + distance * ahead(pose.heading), pose.heading};
}

/// Length of the arc from heading `from` to `to`, turning to `side` (+1 right, -1 left).
double turn_angle(double from, double to, double side) {
  double angle = side * (to - from);
  angle -= 2 * kPi * std::floor(angle / (2 * kPi));
  return angle > 2 * kPi - 1e-6 ? 0.0 : angle;  // rounding must not add a full circle
}

struct Dubins {
  double side_1, angle_1, straight, heading, side_2, angle_2;
  bool valid = false;
};

/// Arc, straight, arc between two poses, turning to the given sides. Dubins 1957, the CSC words.
Dubins connect(const Pose2& from, const Pose2& to, double radius, double side_1, double side_2) {
  const Eigen::Vector2d c1 = from.position + side_1 * radius * right(from.heading);
  const Eigen::Vector2d c2 = to.position + side_2 * radius * right(to.heading);
  const Eigen::Vector2d d = c2 - c1;
  const double distance = d.norm();
  Dubins word{side_1, 0, 0, from.heading, side_2, 0};
  double heading = distance > 1e-9 ? atan2(d.y(), d.x()) : from.heading;
  if (side_1 == side_2) {
    word.straight = distance;
  } else {
    if (distance < 2 * radius) return word;
    // The inner tangent leans towards the second centre's side.
    word.straight = std::sqrt(distance * distance - 4 * radius * radius);
    heading += side_1 * atan2(2 * radius, word.straight);
  }
  word.heading = heading;
  word.angle_1 = turn_angle(from.heading, heading, side_1);
  word.angle_2 = turn_angle(heading, to.heading, side_2);
  word.valid = true;
  return word;
}

/// Least distance from a point of the floor plan to an obstacle; 0 inside.
double distance_to(const MapObstacle& box, const Eigen::Vector2d& p) {
  return std::max(0.0, MapSolid{.footprint = box}.beside(p));
}

/// Straight out of a gate, arc, straight, arc, straight into the next.
struct Candidate {
  double run_out, run_in, radius;
  Dubins word;
  double cost = 0.0;
};

void append(Path& path, Pose2& pose, double length, double curvature) {
  if (length < 1e-4) return;
  // A straight that goes on from a straight is one straight.
  if (curvature == 0.0 && !path.segments.empty() && path.segments.back().curvature == 0.0) {
    path.segments.back().length += length;
  } else {
    path.segments.push_back({pose.position, pose.heading, curvature, length});
  }
  const PathPoint end = point_on({pose.position, pose.heading, curvature, length}, length);
  pose = {end.position, end.heading};
}

Path path_of(const Candidate& way, const Pose2& from, double z_from, double z_to) {
  Path path;
  Pose2 pose = from;
  const Dubins& word = way.word;
  append(path, pose, way.run_out, 0.0);
  append(path, pose, way.radius * word.angle_1, word.side_1 / way.radius);
  append(path, pose, word.straight, 0.0);
  append(path, pose, way.radius * word.angle_2, word.side_2 / way.radius);
  append(path, pose, way.run_in, 0.0);
  path.climb(z_from, z_to);
  return path;
}

/// On its pad the drone stands as near to things as it does: the way from there may be as near.
PlanParams from_the_pad(const Track& track, PlanParams params, double height) {
  double near = 1e9;
  for (const MapSolid& solid : solids_of(track))
    if (solid.kind < MapSolid::Kind::kFloor && solid.bottom < height + params.clearance)
      near = std::min(near, solid.beside(track.start));
  constexpr double kToSpare = 0.02;
  params.clearance = std::clamp(near - params.body_radius - kToSpare, 0.0, params.clearance);
  params.least_clearance = std::min(params.clearance, params.least_clearance);
  return params;
}

/// So far before a gate, on its axis, nothing solid is nearer than the way may come to it [m].
double room_before(const Track& track, const PlanParams& params,
                   const std::vector<MapSolid>& solids, int index) {
  constexpr double kStep = 0.1, kFarthest = 8.0;  // [m]
  const MapGate& gate = track.gates[static_cast<std::size_t>(index)];
  const double wanted = params.clearance + params.body_radius;
  double room = kStep;
  // At most 80 times.
  for (; room < kFarthest; room += kStep) {
    const Pose2 there = moved({gate.p_EG.head<2>(), gate.yaw_EG}, -(room + kStep));
    Path axis;
    (void)axis.segments.push_back({there.position, there.heading, 0.0, room + kStep});
    (void)axis.levels.push_back({0.0, gate.p_EG.z()});
    if (nearest_solid(solids, params, axis, -1, index, wanted).distance < wanted) break;
  }
  return room;
}

/// The pose that a leg begins with.
struct Departure {
  Pose2 from;
  double z = 0.0;  ///< [m, down]
  int gate = -1;   ///< -1: the pad.
};

/// A way to the next gate, or what is in it.
struct Leg {
  std::optional<Path> path;
  std::string blocked;
};

/// RacePlan::room_beside of one way. The frame of the gate that it leads to counts until just before it:
/// a drone that does not know its place stops before the bars, not in them.
std::vector<double> room_beside(const Path& path, const PlanParams& params,
                                const std::vector<MapSolid>& solids, int from_gate, int to_gate) {
  std::vector<double> room;
  for (double s = 0.0; s < path.length(); s += kRoomStep) {
    const double end = std::min(path.length(), s + kRoomStep);
    room.push_back(nearest_between(solids, params, path, {s, end}, from_gate, to_gate).distance -
                   params.body_radius);
  }
  return room;
}

class Planner {
 public:
  Planner(const Track& track, const PlanParams& params)
      : track_{track}, params_{params}, solids_{solids_of(track)} {}

  Leg leg(const Departure& departure, int to_gate) const {
    const auto& [from, z_from, from_gate] = departure;
    const MapGate& goal = track_.gates[static_cast<std::size_t>(to_gate)];
    std::vector<Candidate> candidates = propose(from, from_gate >= 0, goal);
    std::sort(candidates.begin(), candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
    // The cheapest that is clear; room beyond the clearance is worth a detour.
    const double wanted = params_.clearance + params_.body_radius;
    std::optional<Path> best;
    double best_cost = 1e9;
    std::string blocked =
        "no turn of radius >= " + short_text(params_.min_radius) + " m leads there";
    for (const auto& candidate : candidates) {
      if (candidate.cost >= best_cost) break;
      const Path path = path_of(candidate, from, z_from, goal.p_EG.z());
      const Nearest nearest = nearest_solid(solids_, params_, path, from_gate, to_gate, wanted);
      const double margin = nearest.distance - wanted;
      const double cost = candidate.cost + 6.0 * std::max(0.0, 0.4 - margin);
      if (margin < 0.0) {
        blocked = nearest.solid->name() + " is in the way";
      } else if (cost < best_cost) {
        best = path;
        best_cost = cost;
      }
    }
    if (best) return {best, ""};
    WayRound way =
        way_round(solids_, track_, params_,
                  {{from.position.x(), from.position.y(), z_from}, from.heading, from_gate},
                  {goal.p_EG, goal.yaw_EG, to_gate});
    if (way.path) return {*std::move(way.path), ""};
    return {std::nullopt, blocked + "; " + way.blocked};
  }

 private:
  std::vector<Candidate> propose(const Pose2& from, bool from_is_gate, const MapGate& goal) const {
    constexpr std::array kRadii{30.0, 24.0, 19.0, 15.5, 12.5, 10.0, 8.0, 6.5, 5.0, 4.0, 3.0,
                                2.4,  2.0,  1.7,  1.5,  1.3,  1.15, 1.0, 0.9, 0.8, 0.7, 0.6};
    constexpr std::array kRunOut{0.15, 0.3, 0.5, 0.8, 1.2, 1.8};
    constexpr std::array kRunIn{12.0, 10.0, 8.0, 6.5, 5.0, 4.0, 3.0, 2.5, 2.0, 1.6, 1.3, 1.0};
    // Wider arcs and longer run-ins than speed needs are of no use.
    const double widest = std::max(3.0, widest_radius(params_)),
                 longest = std::max(4.0, 2.2 * params_.speed);
    const Pose2 gate{goal.p_EG.head<2>(), goal.yaw_EG};
    std::vector<Candidate> candidates;
    // A single gate flown again and again is the one course that needs a full circle.
    const double most_turning = (from_is_gate && track_.gates.size() == 1 ? 2.2 : 1.6) * kPi;
    for (const double radius : kRadii) {
      if (radius < params_.min_radius || radius > widest) continue;
      for (const double run_out : kRunOut)
        for (const double run_in : kRunIn)
          for (const double side_1 : {-1.0, 1.0})
            for (const double side_2 : {-1.0, 1.0}) {
              const double out = from_is_gate ? run_out : run_out - 0.15;
              const Dubins word =
                  connect(moved(from, out), moved(gate, -run_in), radius, side_1, side_2);
              if (!word.valid || run_in > longest) continue;
              if (word.angle_1 + word.angle_2 > most_turning) continue;  // no loops
              Candidate candidate{out, run_in, radius, word};
              candidate.cost = cost(path_of(candidate, from, 0.0, 0.0), radius, word);
              candidates.push_back(candidate);
            }
    }
    return candidates;
  }

  // Seconds, plus what makes a leg hard to fly: a short straight before the gate, tight turns,
  // turning much.
  double cost(const Path& path, double radius, const Dubins& word) const {
    const double arc_speed = std::min(params_.speed, std::sqrt(params_.max_lateral * radius));
    double seconds = 0.0;
    for (const auto& segment : path.segments)
      seconds += segment.length / (segment.curvature == 0.0 ? params_.speed : arc_speed);
    const double run_in = way_to_settle(path, params_.speed, params_.max_lateral);
    const double turning = word.angle_1 + word.angle_2;
    const double missing = std::max(0.0, wanted_run_in(params_) - run_in) / params_.speed;  // [s]
    return seconds + 3.4 * missing + 0.9 * turning / radius + 0.3 * turning;
  }

  const Track& track_;
  const PlanParams params_;
  std::vector<MapSolid> solids_;
};

/// With the clearance that is wanted; where there is no such way, with the least that is flown.
/// @throws std::invalid_argument saying what is in the way
Path plan_leg(const Track& track, PlanParams params, const Departure& departure, int to_gate) {
  const Leg leg = Planner{track, params}.leg(departure, to_gate);
  if (leg.path) return *leg.path;
  if (params.least_clearance < params.clearance) {
    params.clearance = params.least_clearance;
    const Leg tight = Planner{track, params}.leg(departure, to_gate);
    if (tight.path) return *tight.path;
  }
  const int gate = departure.gate;
  throw std::invalid_argument(
      "no way from " + (gate < 0 ? std::string("the start") : "gate " + std::to_string(gate + 1)) +
      " to gate " + std::to_string(to_gate + 1) + ": " + leg.blocked);
}

}  // namespace

namespace {

/// Backwards over the legs, twice, as the last one of a lap leads to the first.
std::vector<double> gate_speeds(const RacePlan& plan, const PlanParams& params, int gates) {
  std::vector<double> speeds(static_cast<std::size_t>(gates), params.speed);
  const std::size_t legs = plan.legs.size();
  for (std::size_t k = 2 * legs; k-- > 0;) {
    const std::size_t i = k % legs;
    double speed = params.speed, s = plan.legs[i].length();
    const auto slowed_to = [&](double limit, double way) {
      speed = std::min(speed, std::sqrt(limit * limit + 2.0 * params.braking.on_the_way * way));
    };
    slowed_to(speeds[(i + 1) % static_cast<std::size_t>(gates)], s);
    if (!plan.legs[i].stops.empty())
      speed = std::min(speed, std::sqrt(2.0 * params.braking.to_a_stop * plan.legs[i].stops[0].s));
    s = 0.0;
    for (const Segment& segment : plan.legs[i].segments) {
      if (segment.curvature != 0.0) slowed_to(speed_on(segment, params), s);
      s += segment.length;
    }
    speeds[i] = speed;
  }
  return speeds;
}

}  // namespace

RacePlan plan_race(const Track& track, const PlanParams& params) {
  if (track.gates.empty())
    throw std::invalid_argument("the track has no gates: PilotConfig::track.gates is empty");
  if (track.laps < 1)
    throw std::invalid_argument("laps = " + std::to_string(track.laps) + ", must be at least 1");
  for (std::size_t i = 0; i < track.gates.size(); ++i) {
    const MapGate& gate = track.gates[i];
    const std::string name = "gate " + std::to_string(i + 1);
    const double opening = gate.side - 2 * gate.bar;
    if (opening < 2 * params.body_radius + 0.1)
      throw std::invalid_argument(name + " is too small to fly through");
    if (-gate.p_EG.z() < 0.5 * gate.side - kSunk)
      throw std::invalid_argument(name + " is too low: it stands in the floor");
    if (-gate.p_EG.z() + 0.5 * gate.side > track.ceiling)
      throw std::invalid_argument(name + " is too high: it is in the ceiling");
    const auto pass = ahead(gate.yaw_EG);
    for (std::size_t k = 0; k < track.obstacles.size(); ++k)
      for (double s = -0.3; s <= 0.3; s += 0.1)
        if (track.obstacles[k].height > -gate.p_EG.z() - 0.5 * opening &&
            distance_to(track.obstacles[k], gate.p_EG.head<2>() + s * pass) < params.body_radius)
          throw std::invalid_argument("obstacle " + std::to_string(k + 1) +
                                      " stands in the opening of " + name);
  }

  for (std::size_t k = 0; k < track.obstacles.size(); ++k)
    if (distance_to(track.obstacles[k], track.start) < params.body_radius)
      throw std::invalid_argument("the start is in obstacle " + std::to_string(k + 1));

  RacePlan plan;
  const int n = static_cast<int>(track.gates.size());
  const double z_start = std::min(track.gates[0].p_EG.z(), -kTakeOff);
  plan.start = plan_leg(track, from_the_pad(track, params, -z_start),
                        {{track.start, track.start_heading}, z_start, -1}, 0);
  for (int i = 0; i < n; ++i) {
    if (i == n - 1 && track.laps == 1) break;  // the last gate of a single lap leads nowhere
    const MapGate& gate = track.gates[static_cast<std::size_t>(i)];
    plan.legs.push_back(plan_leg(
        track, params, {{gate.p_EG.head<2>(), gate.yaw_EG}, gate.p_EG.z(), i}, (i + 1) % n));
  }
  plan.gate_speed = gate_speeds(plan, params, n);
  const std::vector<MapSolid> solids = solids_of(track);
  for (int i = 0; i < n; ++i) plan.room_before.push_back(room_before(track, params, solids, i));
  plan.room_beside.push_back(room_beside(plan.start, params, solids, -1, 0));
  for (int i = 0; i < static_cast<int>(plan.legs.size()); ++i)
    plan.room_beside.push_back(
        room_beside(plan.legs[static_cast<std::size_t>(i)], params, solids, i, (i + 1) % n));
  return plan;
}

double widest_radius(const PlanParams& params) {
  return 1.5 * params.speed * params.speed / params.max_lateral;
}

double way_to_settle(const Path& path, double speed, double max_lateral) {
  constexpr double kSeenFrom = 0.6;  // so far aside of the nose a gate is still in view [rad]
  double way = 0.0, turned = 0.0;
  for (std::size_t i = path.segments.size(); i-- > 0;) {
    const Segment& segment = path.segments[i];
    const double curvature = std::abs(segment.curvature);
    if (curvature == 0.0) {
      way += segment.length;
      continue;
    }
    const double asked = speed * speed * curvature / max_lateral;
    const double gentle = std::clamp(2.0 * (1.0 - asked), 0.0, 1.0);
    const double part = std::min(segment.length, (kSeenFrom - turned) / curvature);
    way += gentle * part;
    turned += curvature * part;
    if (gentle == 0.0 || part < segment.length) break;
  }
  return way;
}

double wanted_run_in(const PlanParams& params) {
  constexpr double kSeconds = 1.4;
  return std::max(params.run_in, kSeconds * params.speed);
}

double speed_on(const Segment& segment, const PlanParams& params) {
  if (segment.curvature == 0.0) return params.speed;
  return std::min(params.speed, std::sqrt(params.max_lateral / std::abs(segment.curvature)));
}

Clearance clearance_of(const Path& path, const Track& track, const PlanParams& params,
                       int from_gate, int to_gate) {
  const std::vector<MapSolid> solids = solids_of(track);
  const Nearest nearest = nearest_solid(solids, params, path, from_gate, to_gate, -1e9);
  return {nearest.distance - params.body_radius, nearest.solid ? nearest.solid->name() : ""};
}

}  // namespace gatefly
