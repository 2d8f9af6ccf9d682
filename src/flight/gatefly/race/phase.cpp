// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/phase.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

bool gate_is_uncertain(const Situation& now, const PhaseParams& params) {
  if (!params.goes_around) return false;
  if (now.gate_x < -params.search_before || now.gate_x > -params.search_until) return false;
  if (now.to_go > params.search_before + params.search_detour) return false;
  // Right after another gate this one had no time to be seen.
  const bool unseen = std::min(now.since_fix, now.since_gate) > params.unseen_after &&
                      now.lateral_sigma > params.max_lateral_sigma;
  // A late detection that leaves no room is a reason to go around, too.
  const bool off_axis = std::abs(now.gate_y_ahead) > params.max_miss;
  return unseen || off_axis;
}

// Above the pad a wrong heading, or a gate that is not there, costs nothing yet.
bool first_gate_is_missing(const Situation& now, const PhaseParams& params) {
  return params.goes_around && params.first_gate_timeout > 0.0 && now.gate_expected &&
         now.picture_interval < params.lost_pictures && now.since_fix > params.seen_at_start;
}

// How far it may have drifted and still fly on.
double most_drift(const Situation& now, const PhaseParams& params) {
  return std::max(params.lost_sigma, params.lost_part * now.room_beside);
}

// Nothing has told for so long where it is that it may be as far aside as the next wall.
bool is_lost(const Situation& now, const PhaseParams& params) {
  return params.goes_around && now.to_stop > params.lost_before_stop &&
         now.picture_interval < params.lost_pictures && now.drift_sigma > most_drift(now, params);
}

// A stand that drifts on. Gates in view, though they contradict, may tell where it is.
bool is_hopeless(const Search& stand, const Situation& now, const PhaseParams& params) {
  return is_lost(now, params) && now.since_doubt > params.doubt_settles &&
         now.drift_sigma > params.hopeless * std::max(stand.drift, most_drift(now, params));
}

bool knows_its_place(const Situation& now, const PhaseParams& params) {
  return now.drift_sigma < params.certain_part * params.lost_sigma;
}

bool gate_found_again(const Situation& now, const PhaseParams& params) {
  // The less way is left, the nearer to the axis it has to be.
  const double way = -now.gate_x - params.min_run_in;
  const double miss = std::min(params.max_found_miss, params.max_miss + params.found_slope * way);
  // Other gates may tell where this one is, where it cannot be seen itself.
  return (now.since_fix < params.seen_within || !now.shows_whole) &&
         now.lateral_sigma < params.certain_part * params.max_lateral_sigma && way > 0.0 &&
         std::abs(now.gate_y) < miss && now.speed < params.max_found_speed;
}

// How phases begin.
Phase search_from(const Situation& now, const PhaseParams& params) {
  const double wanted = std::min(-params.wait_before, now.gate_x - params.fall_back);
  const double room =
      std::max(std::min(now.room_before, params.wait_before), now.room_before - params.drift);
  return Search{now.time, std::max(wanted, -room)};
}
Phase stand_from(const Situation& now, const PhaseParams& params) {
  return Search{.since = now.time,
                .gate_x = now.gate_x,
                .stand_at = now.p_EB + params.stops_within * now.v_E,
                .yaw = now.yaw,
                .rate = params.turn_rate,
                .drift = now.drift_sigma};
}
// The waiting place and its time are kept.
Phase stand_from(const Search& search, const Situation& now, const PhaseParams& params) {
  Search stand = std::get<Search>(stand_from(now, params));
  stand.gate_x = search.gate_x, stand.waited_since = search.since;
  return stand;
}
// A stand that knows its place goes back to where it was on its way to.
Phase after(const Search& stand) {
  if (stand.waited_since) return Search{*stand.waited_since, stand.gate_x};
  return Straight{};
}
Phase turn_from(const Situation& now) {
  return Turn{{.yaw = now.yaw, .v_F = {now.forward_speed, 0, 0}}};
}
Phase land_from(const Situation& now) { return Land{now.time, -now.height}; }
Phase hurry_down_from(const Situation& now) { return Land{now.time, -now.height, true}; }

bool imu_is_lost(const Situation& now, const PhaseParams& params) {
  return now.imu_stuck || now.since_imu > params.imu_timeout;
}

// None at all: a picture without a gate is one. A camera whose pictures are rare is given longer.
bool camera_is_dead(const Situation& now, const PhaseParams& params) {
  return now.since_picture > params.picture_timeout &&
         now.since_picture > params.picture_intervals * now.picture_interval;
}

struct Next {
  const Situation& now;
  const PhaseParams& params;

  Transition on_course() const {
    if (is_lost(now, params)) return {stand_from(now, params)};
    if (gate_is_uncertain(now, params)) return {search_from(now, params)};
    if (now.turn_ahead) return {turn_from(now)};
    return {Straight{}};
  }

  Transition operator()(const OnGround& phase) const {
    if (now.lifted || now.rest_samples >= params.rest_samples) return {TakeOff{now.time}};
    return {phase};
  }
  Transition operator()(const TakeOff& phase) const {
    const bool high = now.height > params.go_height,
               late = now.time - phase.since > params.go_after;
    if (high && first_gate_is_missing(now, params)) {
      const double since = phase.waits_since.value_or(now.time);
      if (now.time - since > params.first_gate_timeout)
        return {hurry_down_from(now), AbortReason::kGateNotFound};
      return {TakeOff{phase.since, since}};
    }
    if (high && (late || params.go_after <= 0.0)) return {Straight{}};
    if (now.time - phase.since > params.climb_timeout)
      return {land_from(now), AbortReason::kNoClimb};
    return {phase};
  }
  Transition operator()(const Straight&) const { return on_course(); }
  Transition operator()(const Turn& phase) const {
    const Transition next = on_course();
    // The arc keeps its prediction.
    if (std::holds_alternative<Turn>(next.phase)) return {phase};
    return next;
  }
  Transition operator()(const Search& phase) const {
    const Transition give_up{hurry_down_from(now), AbortReason::kGateNotFound};
    const double waited = now.time - phase.since;
    if (phase.stand_at) {
      if (knows_its_place(now, params)) return {after(phase)};
      const bool late = waited > params.turns * 2 * kPi / phase.rate;
      return late || is_hopeless(phase, now, params) ? give_up : Transition{phase};
    }
    if (gate_found_again(now, params)) return {Straight{}};
    if (waited > params.search_timeout) return give_up;
    return {is_lost(now, params) ? stand_from(phase, now, params) : phase};
  }
  Transition operator()(const Land& phase) const {
    const bool late = now.time - phase.since > params.land_timeout;
    if (now.height < params.landed_height || late) return {Landed{}};
    return {phase};
  }
  Transition operator()(const Landed& phase) const { return {phase}; }
};

}  // namespace

bool is_flying(const Phase& phase) {
  return !std::holds_alternative<OnGround>(phase) && !std::holds_alternative<Land>(phase) &&
         !std::holds_alternative<Landed>(phase);
}

Transition next_phase(const Phase& phase, const Situation& now, const PhaseParams& params) {
  const bool motors_on = is_flying(phase) || std::holds_alternative<Land>(phase);
  if (motors_on && now.tilt > params.max_tilt) return {Landed{}, AbortReason::kUpset};
  if (motors_on && params.cuts_without_imu && imu_is_lost(now, params))
    return {Landed{}, AbortReason::kSensorsLost};
  if (is_flying(phase)) {
    if (imu_is_lost(now, params)) return {land_from(now), AbortReason::kSensorsLost};
    if (now.course_done) return {land_from(now)};
    if (camera_is_dead(now, params)) return {hurry_down_from(now), AbortReason::kNoPictures};
  }
  return std::visit(Next{now, params}, phase);
}

const char* name_of(const Phase& phase) {
  constexpr const char* kNames[] = {"ground", "take-off", "straight", "turn",
                                    "search", "land",     "landed"};
  return kNames[phase.index()];
}

const char* text_of(AbortReason reason) {
  switch (reason) {
    case AbortReason::kNone:
      return "";
    case AbortReason::kGateNotFound:
      return "the next gate was not found";
    case AbortReason::kNoClimb:
      return "the drone did not climb";
    case AbortReason::kUpset:
      return "the drone tipped over";
    case AbortReason::kSensorsLost:
      return "the IMU went silent";
    case AbortReason::kNoPictures:
      return "no pictures come";
  }
  return "";
}

}  // namespace gatefly
