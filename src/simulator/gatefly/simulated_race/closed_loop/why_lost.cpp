// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/why_lost.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string_view>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::simulated_race {
namespace {

using How = WhyLost::How;
using Cause = WhyLost::Cause;

/// The number behind "gate " in "gate 3 right bar", from 0.
std::optional<std::size_t> number_after(std::string_view text, std::string_view word) {
  if (!text.starts_with(word)) return std::nullopt;
  std::size_t number = 0;
  const auto [end, error] =
      std::from_chars(text.data() + word.size(), text.data() + text.size(), number);
  if (error != std::errc{} || number < 1) return std::nullopt;
  return number - 1;
}

/// The reference that a miss is measured from.
struct Aim {
  Eigen::Vector3d p_E;  ///< By the map [m].
  double heading = 0.0;
  Eigen::Vector3d shift_E;  ///< The map's error there: map less truth [m].
  bool is_gate = false;     ///< Middle of a gate; how far along its axis is no miss.
  bool counts_along = true;
};

Eigen::Vector3d shift_of(const LossPlace& place, std::size_t gate) {
  return place.map.gates[gate].p_EG - place.world.gates[gate].p_EG;
}

std::size_t counted_last(const LossMoment& now, std::size_t gates) {
  return (static_cast<std::size_t>(std::max(now.counted, 1)) - 1) % gates;
}

Aim at_gate(const LossMoment& now, const LossPlace& place, std::size_t gate) {
  const MapGate& map = place.map.gates[gate];
  const bool is_target = static_cast<int>(gate) == now.target;
  return {map.p_EG, place.world.gates[gate].yaw_EG, shift_of(place, gate), true, !is_target};
}

/// The gate whose middle was aimed at, if it was that.
std::optional<std::size_t> gate_aimed_at(const LossMoment& now, const LossPlace& place, How how,
                                         const std::string& object) {
  const std::size_t gates = place.world.gates.size();
  if (how == How::kMissedGate) return counted_last(now, gates);
  const auto touched = number_after(object, "gate ");
  if (!touched || *touched >= gates) return std::nullopt;
  const bool counted = now.counted > 0 && *touched == counted_last(now, gates);
  if (counted || static_cast<int>(*touched) == now.target) return touched;
  return std::nullopt;
}

/// A place of the planned way. @param at_target  the target gate is what counts, else the room.
Aim on_the_way(const LossMoment& now, const LossPlace& place, bool at_target) {
  const auto target = static_cast<std::size_t>(now.target);
  const MapGate& gate = place.map.gates[target];
  Aim aim{now.p_EB, gate.yaw_EG, Eigen::Vector3d::Zero()};
  if (at_target) aim.shift_E = shift_of(place, target);
  switch (now.flying) {
    case LossMoment::Flying::kTakeOff:
      aim.p_E.head<2>() = place.map.start;
      aim.heading = place.map.start_heading;
      break;
    case LossMoment::Flying::kSearch:
      aim.p_E = gate.p_EG + rotation_z(gate.yaw_EG) * Eigen::Vector3d{now.wait_x, 0, 0};
      break;
    case LossMoment::Flying::kLand:
      break;
    case LossMoment::Flying::kCourse: {
      const std::size_t legs = place.plan.legs.size();
      const Path& path = now.counted == 0 || legs == 0 ? place.plan.start
                                                       : place.plan.legs[counted_last(now, legs)];
      const double s = path.nearest(now.p_EB.head<2>(), 0.0, path.length());
      const PathPoint point = path.at(s);
      aim.p_E << point.position, path.z_at(s);
      aim.heading = point.heading;
    }
  }
  return aim;
}

void split(WhyLost& why, const LossMoment& now, const LossPlace& place, const Aim& aim) {
  const Eigen::Matrix3d R = rotation_z(-aim.heading);
  const auto target = static_cast<std::size_t>(now.target);
  why.estimate = R * now.estimate;
  why.detection = R * now.detection;
  why.map = R * (now.map + aim.shift_E - shift_of(place, target));
  why.guidance = R * (now.p_EB - aim.p_E);
  if (aim.is_gate) why.guidance.x() = 0.0;
  why.miss = why.estimate + why.guidance + why.map + why.detection;
  if (now.fix_error) why.fix_error = R * *now.fix_error;
  why.wind = rotation_z(-aim.heading).topLeftCorner<2, 2>() * now.wind_E;

  Eigen::Vector3d direction = why.miss;
  if (!aim.counts_along) direction.x() = 0.0;
  if (direction.norm() < 1e-3) return;
  direction.normalize();
  why.shares = {direction.dot(why.estimate), direction.dot(why.guidance), direction.dot(why.map),
                direction.dot(why.detection)};
}

/// Not on the pilot's map, and met where it was meant to fly.
bool stood_in_the_way(const WhyLost& why, const std::string& object) {
  constexpr double kClearance = 0.35;  // of the planned way [m]
  const bool unknown = object.starts_with("person") || object.starts_with("decoy") ||
                       object.starts_with("false gate");
  return unknown && why.miss.norm() < kClearance;
}

Cause cause_of(const WhyLost& why, const LossPlace& place, const LossMoment& now,
               const std::string& object) {
  constexpr int kOften = 3;      // pictures
  constexpr double kFar = 0.35;  // [m]
  if (why.how == How::kGivenUp) return Cause::kGivenUp;
  if (stood_in_the_way(why, object)) return Cause::kInTheWay;
  if (why.how == How::kNotFound || why.how == How::kTimeout) {
    if (place.world.gates[static_cast<std::size_t>(now.target)].missing) return Cause::kMap;
    const bool searching = now.flying == LossMoment::Flying::kSearch || why.how == How::kNotFound;
    if (searching && now.looks.gate_in_view >= kOften) return Cause::kDetection;
    if (why.how == How::kTimeout && why.miss.norm() < kFar) return Cause::kTimeout;
  }
  constexpr std::array kCauses{Cause::kEstimate, Cause::kGuidance, Cause::kMap, Cause::kDetection};
  const auto most = std::max_element(why.shares.begin(), why.shares.end());
  return kCauses[static_cast<std::size_t>(most - why.shares.begin())];
}

}  // namespace

std::string named(const std::string& object, const world::World& world) {
  for (const std::string_view kind : {"gate ", "false gate "}) {
    if (!number_after(object, kind)) continue;
    const std::size_t space = object.find(' ', kind.size());
    if (space == std::string::npos) return object;
    return object.substr(space + 1) + " of " + object.substr(0, space);
  }
  const auto shape = [&](bool pole) { return object + (pole ? " (a pole)" : " (a box)"); };
  if (const auto i = number_after(object, "obstacle "); i && *i < world.obstacles.size())
    return shape(world.obstacles[*i].pole);
  if (const auto i = number_after(object, "decoy "); i && *i < world.decoys.size())
    return shape(world.decoys[*i].shape.pole);
  return object;
}

WhyLost why_lost(const LossMoment& moment, const LossPlace& place, How how,
                 const std::string& object) {
  WhyLost why;
  why.how = how, why.time = moment.time, why.gate = moment.passed + 1;
  why.object = object.empty() ? "" : named(object, place.world);
  why.since_fix = moment.since_fix, why.wrong_fix = moment.wrong_fix, why.looks = moment.looks;
  const auto gate = gate_aimed_at(moment, place, how, object);
  why.from_gate = gate.has_value();
  const std::size_t next = static_cast<std::size_t>(moment.passed) % place.world.gates.size();
  why.at_its_gate = gate && *gate == next;
  const bool at_target = how == How::kNotFound || how == How::kTimeout;
  split(why, moment, place,
        gate ? at_gate(moment, place, *gate) : on_the_way(moment, place, at_target));
  why.cause = cause_of(why, place, moment, object);
  return why;
}

}  // namespace gatefly::simulated_race
