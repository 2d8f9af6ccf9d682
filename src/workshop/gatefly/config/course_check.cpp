// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/course_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "gatefly/geometry/math.hpp"

namespace gatefly::config {
namespace {

constexpr double kToWall = 0.3;     // of a gate's frame [m]
constexpr double kToCeiling = 0.1;  // [m]
constexpr double kSunk = 1e-6;      // a gate that stands on the floor may be so low by rounding [m]
constexpr double kApart = 0.5;      // two frames [m]
constexpr double kOffGate = 0.3;    // an obstacle from a frame [m]
constexpr double kFreeWay = 1.0;    // before and behind an opening [m]
constexpr double kStartFree = 0.5;  // around the start [m]
constexpr double kStep = 0.05;      // between the points that stand for a frame or a way [m]

std::string gate_name(std::size_t i) { return "gate " + std::to_string(i + 1); }
std::string obstacle_name(std::size_t i) { return "obstacle " + std::to_string(i + 1); }

/// Distance from a point of the floor plan to a box; 0 inside.
double distance_to(const MapObstacle& box, const Eigen::Vector2d& p) {
  const auto [s, c] = sincos(box.heading);
  const Eigen::Vector2d d = p - box.center;
  const Eigen::Vector2d own{c * d.x() + s * d.y(), c * d.y() - s * d.x()};
  return (own.cwiseAbs() - 0.5 * box.size).cwiseMax(0.0).norm();
}

/// How far inside the walls a point of the floor plan is; negative outside.
double inside(const Track& track, const Eigen::Vector2d& p) {
  return (0.5 * track.room_size - (p - track.room_center).cwiseAbs()).minCoeff();
}

/// A frame from above, as points from one end to the other.
std::vector<Eigen::Vector2d> frame_of(const MapGate& gate) {
  const auto [s, c] = sincos(gate.yaw_EG);
  const Eigen::Vector2d right{-s, c};
  std::vector<Eigen::Vector2d> points;
  const int steps = static_cast<int>(std::ceil(gate.side / kStep));
  for (int i = 0; i <= steps; ++i)
    points.emplace_back(gate.p_EG.head<2>() +
                        gate.side * (static_cast<double>(i) / steps - 0.5) * right);
  return points;
}

/// The straight way through an opening, as wide as the frame.
MapObstacle way_through(const MapGate& gate) {
  return {.center = gate.p_EG.head<2>(), .size = {2 * kFreeWay, gate.side}, .heading = gate.yaw_EG};
}

double nearest(const std::vector<Eigen::Vector2d>& points, const MapObstacle& box) {
  double distance = 1e9;
  for (const Eigen::Vector2d& p : points) distance = std::min(distance, distance_to(box, p));
  return distance;
}

/// A box from above, as points all over it.
std::vector<Eigen::Vector2d> points_of(const MapObstacle& box) {
  const auto [s, c] = sincos(box.heading);
  const auto steps = [](double size) { return static_cast<int>(std::ceil(size / kStep)); };
  const int rows = steps(box.size.x()), columns = steps(box.size.y());
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j <= columns; ++j) {
      const double a = box.size.x() * (static_cast<double>(i) / rows - 0.5),
                   b = box.size.y() * (static_cast<double>(j) / columns - 0.5);
      points.emplace_back(box.center + Eigen::Vector2d{c * a - s * b, s * a + c * b});
    }
  return points;
}

/// Neither of them is above the other, frames that stand on each other included.
bool side_by_side(const MapGate& one, const MapGate& other) {
  return std::abs(one.p_EG.z() - other.p_EG.z()) < 0.5 * (one.side + other.side) - kSunk;
}

class Check {
 public:
  explicit Check(const Track& track) : track_{track} {}

  std::vector<std::string> problems() {
    for (std::size_t i = 0; i < track_.gates.size(); ++i) gate(i);
    for (std::size_t i = 0; i < track_.obstacles.size(); ++i) obstacle(i);
    start();
    return problems_;
  }

 private:
  void say(const std::string& what) { problems_.push_back(what); }

  void gate(std::size_t i) {
    const MapGate& gate = track_.gates[i];
    const double low = -gate.p_EG.z() - 0.5 * gate.side, high = low + gate.side;
    const std::vector<Eigen::Vector2d> frame = frame_of(gate);
    if (low < -kSunk) say(gate_name(i) + " reaches into the floor");
    if (high > track_.ceiling - kToCeiling) say(gate_name(i) + " reaches the ceiling");
    for (const Eigen::Vector2d& end : {frame.front(), frame.back()})
      if (inside(track_, end) < kToWall) return say(gate_name(i) + " is too near a wall");
    for (std::size_t j = 0; j < track_.gates.size(); ++j) {
      const MapGate& other = track_.gates[j];
      if (!side_by_side(gate, other)) continue;
      const MapObstacle bars{
          .center = other.p_EG.head<2>(), .size = {other.bar, other.side}, .heading = other.yaw_EG};
      if (j > i && nearest(frame, bars) < kApart)
        say(gate_name(i) + " and " + gate_name(j) + " are too near each other");
      if (j != i && nearest(frame_of(other), way_through(gate)) == 0.0)
        say(gate_name(j) + " stands in the way through " + gate_name(i));
    }
  }

  void obstacle(std::size_t i) {
    const MapObstacle& box = track_.obstacles[i];
    const std::vector<Eigen::Vector2d> points = points_of(box);
    for (const Eigen::Vector2d& p : points)
      if (inside(track_, p) < 0.0) return say(obstacle_name(i) + " is not inside the room");
    if (box.height > track_.ceiling) say(obstacle_name(i) + " is higher than the room");
    for (std::size_t j = 0; j < track_.gates.size(); ++j) {
      const MapGate& gate = track_.gates[j];
      if (nearest(frame_of(gate), box) < kOffGate)
        say(obstacle_name(i) + " is too near " + gate_name(j));
      const bool high = box.height > -gate.p_EG.z() - 0.5 * gate.side;
      if (high && nearest(points, way_through(gate)) == 0.0)
        say(obstacle_name(i) + " stands in the way through " + gate_name(j));
    }
  }

  void start() {
    if (inside(track_, track_.start) < kStartFree) say("the start is too near a wall");
    for (std::size_t i = 0; i < track_.gates.size(); ++i)
      for (const Eigen::Vector2d& p : frame_of(track_.gates[i]))
        if ((p - track_.start).norm() < kStartFree)
          return say("the start is too near " + gate_name(i));
    for (std::size_t i = 0; i < track_.obstacles.size(); ++i)
      if (distance_to(track_.obstacles[i], track_.start) < kStartFree)
        say("the start is too near " + obstacle_name(i));
  }

  const Track& track_;
  std::vector<std::string> problems_;
};

}  // namespace

std::vector<std::string> course_problems(const Track& track) { return Check{track}.problems(); }

}  // namespace gatefly::config
