// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/logbook.hpp"

#include <algorithm>
#include <cstddef>
#include <variant>

namespace gatefly::simulated_race {

void Logbook::moved(const sim::BodyState& state, double dt, bool racing) {
  if (!racing || passes_.empty()) return;
  path_since_first_ += state.v_E.norm() * dt;
  max_speed_ = std::max(max_speed_, state.v_E.norm());
}

void Logbook::passed(const sim::GatePass& pass) {
  passes_.push_back(pass);
  path_at_last_ = path_since_first_;
}

void Logbook::motors(const Command& command, double now) {
  if (motors_on_ < 0.0 && command.motors[0] > 0.0) motors_on_ = now;
}

void Logbook::looked(const Pilot& pilot, const sim::BodyPose& pose, const sim::Sight& sight) {
  scorer_.score(pose, pilot.sighting(), pilot.target_gate(), sight);
  loss_.taken_of(scorer_.taken_of(pose, pilot.sighting(), pilot.target_gate()));
  has_looked_ = true;
}

void Logbook::flown(const Pilot& pilot, const sim::BodyState& truth, double now, bool racing) {
  const bool searching = std::holds_alternative<Search>(pilot.phase());
  searches_ += searching && !was_searching_;
  was_searching_ = searching;
  if (racing) consistency_.update(belief_of(pilot, has_looked_), truth.p_EB, now);
  if (racing) discoveries_.update(pilot, truth, now, passes_.size());
  if (racing)
    loss_.update(pilot, truth, now, static_cast<int>(passes_.size()),
                 has_looked_ ? &scorer_ : nullptr);
  has_looked_ = false;
  if (passes_.empty() || !racing) return;
  error2_ += (pilot.estimate().p_EB - truth.p_EB).cwiseAbs2();
  ++error_count_;
}

WhyLost Logbook::why_lost(const Pilot& pilot, const RaceResult& result) const {
  return loss_.why(pilot, result.stop_reason, result.crash_object);
}

void Logbook::fill(RaceResult& result) const {
  result.gates_passed = static_cast<int>(passes_.size());
  for (const auto& pass : passes_) result.gate_offsets.push_back(pass.offset);
  double lap_start = motors_on_;
  for (std::size_t i = 0; i < passes_.size(); ++i)
    if ((i + 1) % gates_per_lap_ == 0) {
      result.lap_times.push_back(passes_[i].time - lap_start);
      lap_start = passes_[i].time;
    }
  if (!passes_.empty()) result.race_time = passes_.back().time - motors_on_;
  if (passes_.size() > 1)
    result.mean_speed = path_at_last_ / (passes_.back().time - passes_.front().time);
  result.max_speed = max_speed_;
  if (error_count_ > 0) result.estimation_rmse = (error2_ / error_count_).cwiseSqrt();
  result.searches = searches_;
  result.consistency = consistency_.result();
  result.discoveries = discoveries_.result();
  result.frames = scorer_.frames();
  result.frames_with_gate = scorer_.frames_with_gate();
  result.true_positives = scorer_.true_positives();
  result.false_positives = scorer_.false_positives();
  result.careful_searches = scorer_.careful();
}

}  // namespace gatefly::simulated_race
