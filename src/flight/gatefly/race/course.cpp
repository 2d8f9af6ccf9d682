// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/course.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/race/paper/exit_plan.hpp"

namespace gatefly {
namespace {

constexpr double kBeyond = 1e-3;  // so far behind a stop the path has its new heading [m]

}  // namespace

Course::Course(const Track& track, const PlanParams& plan, const CourseParams& params)
    : Course{track, plan_race(track, plan), params} {}

Course Course::by_exits(const Track& track, const CourseParams& params) {
  Course course{track, plan_from_exits(track), params};
  course.by_exits_ = true;
  return course;
}

Course::Course(const Track& track, RacePlan plan, const CourseParams& params)
    : track_{track},
      params_{params},
      plan_{std::move(plan)},
      total_{static_cast<int>(track.gates.size()) * track.laps} {}

const MapGate& Course::gate() const { return track_.gates[static_cast<std::size_t>(target_)]; }

double Course::gate_speed() const {
  const auto index = static_cast<std::size_t>(target_);
  const bool last = passed_ + 1 >= total_;
  return !last && index < plan_.gate_speed.size() ? plan_.gate_speed[index] : 1e9;
}

double Course::room_before() const {
  const auto index = static_cast<std::size_t>(target_);
  return index < plan_.room_before.size() ? plan_.room_before[index] : 1e9;
}

double Course::room_beside(double distance) const {
  const std::size_t legs = plan_.legs.size();
  const std::size_t way =
      passed_ == 0 || legs == 0 ? 0 : 1 + static_cast<std::size_t>(passed_ - 1) % legs;
  double room = 1e9;
  if (way >= plan_.room_beside.size()) return room;
  const std::vector<double>& beside = plan_.room_beside[way];
  // An approach ends where its leg does.
  const double length = kRoomStep * static_cast<double>(beside.size()),
               begins = approach_ ? std::max(0.0, length - approach_->length()) : 0.0,
               here = begins + progress_;
  const auto last = static_cast<std::size_t>((here + distance) / kRoomStep);
  for (auto i = static_cast<std::size_t>(here / kRoomStep); i <= last && i < beside.size(); ++i)
    room = std::min(room, beside[i]);
  return room;
}

const Path& Course::path() const {
  if (approach_) return *approach_;
  const std::size_t legs = plan_.legs.size();
  if (passed_ == 0 || legs == 0) return plan_.start;
  return plan_.legs[static_cast<std::size_t>(passed_ - 1) % legs];
}

bool Course::follow(const NavigationState& now, const Phase& phase) {
  if (std::holds_alternative<OnGround>(phase) || (finished() && !leads_on())) return false;
  const double total = path().length();
  const Stop* next = stop();
  const double most = next != nullptr ? next->s : total + 0.5;
  progress_ = path().nearest(now.p_EB.head<2>(), std::max(left_, progress_ - params_.back),
                             std::min(progress_ + params_.ahead, most));
  if (next != nullptr && has_stopped(*next, now)) {
    left_ = progress_ = next->s + kBeyond;
    ++stops_done_;
  }
  if (finished()) return false;
  if (by_exits_) {
    // Passed at the turn point [Li18 code; there within 5 cm of it, which a jump can miss].
    const double turn_point = gate().exit ? gate().exit->run : params_.past;
    const bool there = now.p_GB.x() >= turn_point;
    return std::holds_alternative<Straight>(phase) && !before_approach_ && there && pass_gate();
  }
  // While searching, only what went through the opening has passed.
  const bool on_course =
      std::holds_alternative<Straight>(phase) || std::holds_alternative<Turn>(phase);
  const bool through =
      std::holds_alternative<Search>(phase) && std::abs(now.p_GB.y()) < 0.5 * gate().side;
  const bool behind = total - progress_ < params_.end && now.p_GB.x() > params_.past;
  return (on_course || through) && behind && pass_gate();
}

bool Course::pass_gate() {
  ++passed_;
  approach_.reset();
  progress_ = left_ = 0.0;
  stops_done_ = 0;
  if (finished()) return false;
  target_ = (target_ + 1) % static_cast<int>(track_.gates.size());
  before_approach_ = by_exits_ && path().segments.size() > 2;  // else there is no turn
  return true;
}

bool Course::ran_out() const {
  double wanted = params_.run_out;
  if (const Stop* next = stop()) wanted = std::min(wanted, next->s - params_.stopped_within);
  return finished() && (!leads_on() || progress_ >= wanted);
}

// A race of a single lap has no leg that leads away from its last gate.
bool Course::leads_on() const { return !by_exits_ && plan_.legs.size() == track_.gates.size(); }

const Stop* Course::stop() const {
  const auto& stops = path().stops;
  return stops_done_ < stops.size() ? &stops[stops_done_] : nullptr;
}

double Course::ahead(double distance) const {
  const Stop* next = stop();
  const double s = progress_ + distance;
  return next != nullptr ? std::min(s, next->s) : s;
}

bool Course::has_stopped(const Stop& stop, const NavigationState& now) const {
  const Eigen::Vector2d off = path().at(stop.s).position - now.p_EB.head<2>();
  return off.norm() < params_.stopped_within && now.v_E.norm() < params_.stopped_speed &&
         std::abs(stop.z - now.p_EB.z()) < params_.stopped_height &&
         std::abs(wrap_angle(stop.heading - now.attitude.yaw)) < params_.stopped_angle;
}

std::optional<double> Course::approach_length() const {
  if (!by_exits_) return std::nullopt;
  return path().segments.back().length;
}

Eigen::Vector2d Course::turn_end() const {
  const auto& segments = path().segments;
  const Segment& last = segments[segments.size() > 1 ? segments.size() - 2 : 0];
  return point_on(last, last.length).position;
}

void Course::begin_approach() {
  progress_ = path().length() - path().segments.back().length;
  before_approach_ = false;
}

void Course::approach_straight(const NavigationState& now) {
  const double before = std::max(params_.shortest_approach, -now.p_GB.x() + 0.5);
  const Eigen::Vector3d start =
      gate().p_EG + rotation_z(gate().yaw_EG) * Eigen::Vector3d{-before, 0, 0};
  approach_.emplace();
  (void)approach_->segments.push_back(
      {.start = start.head<2>(), .heading = gate().yaw_EG, .curvature = 0.0, .length = before});
  (void)approach_->levels.push_back({0.0, gate().p_EG.z()});
  progress_ = 0.5;
  left_ = 0.0, stops_done_ = 0;
}

}  // namespace gatefly
