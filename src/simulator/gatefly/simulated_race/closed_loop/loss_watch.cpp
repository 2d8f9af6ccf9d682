// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/loss_watch.hpp"

#include <cstddef>
#include <variant>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::simulated_race {
namespace {

LossMoment::Flying flying(const Phase& phase) {
  if (std::holds_alternative<OnGround>(phase) || std::holds_alternative<TakeOff>(phase))
    return LossMoment::Flying::kTakeOff;
  if (std::holds_alternative<Search>(phase)) return LossMoment::Flying::kSearch;
  if (std::holds_alternative<Land>(phase) || std::holds_alternative<Landed>(phase))
    return LossMoment::Flying::kLand;
  return LossMoment::Flying::kCourse;
}

ErrorLedger::Fix fix_of(const Sighting& sighting) {
  const FixOnCourse& fix = *sighting.fix;
  // Without degrees of freedom nothing was weighed: the filter has begun anew.
  return {fix.p_EB, fix.covariance, fix.has_height, sighting.nis_dof == 0};
}

LooksSinceFix looks_of(const Scorer& scorer) {
  return {scorer.frames(), scorer.frames_with_gate(), scorer.true_positives()};
}

}  // namespace

Eigen::Vector3d LossWatch::map_shift(int gate) const {
  const auto i = static_cast<std::size_t>(gate);
  return map_.gates[i].p_EG - world_.gates[i].p_EG;
}

void LossWatch::note_sighting(const Pilot& pilot, const Scorer& looked) {
  const LooksSinceFix all = looks_of(looked);
  if (pilot.sighting().source != Sighting::Source::kNone) {
    at_fix_ = all;
    if (!taken_of_.empty()) now_.wrong_fix = {now_.time, taken_of_};
  }
  now_.looks = {all.pictures - at_fix_.pictures, all.gate_in_view - at_fix_.gate_in_view,
                all.gate_found - at_fix_.gate_found};
}

void LossWatch::update(const Pilot& pilot, const sim::BodyState& truth, double now, int passed,
                       const Scorer* looked) {
  const Estimate estimate = pilot.estimate();
  const Sighting& sighting = pilot.sighting();
  const int target = pilot.target_gate();
  const Eigen::Matrix3d R_EG = rotation_z(map_.gates[static_cast<std::size_t>(target)].yaw_EG);
  const bool fixed = looked != nullptr && sighting.fix.has_value();
  ledger_.add({.true_p_EB = truth.p_EB,
               .p_EB = estimate.p_EB,
               .covariance = R_EG * estimate.covariance_GB * R_EG.transpose(),
               .map_shift = map_shift(target),
               .fix = fixed ? std::optional{fix_of(sighting)} : std::nullopt});
  now_.time = now;
  now_.true_p_EB = truth.p_EB, now_.p_EB = estimate.p_EB;
  now_.estimate = ledger_.estimate(), now_.detection = ledger_.detection();
  now_.map = ledger_.map(), now_.fix_error = ledger_.fix_error();
  now_.target = target, now_.counted = estimate.gates_passed, now_.passed = passed;
  now_.flying = flying(pilot.phase());
  if (const auto* search = std::get_if<Search>(&pilot.phase())) now_.wait_x = search->gate_x;
  now_.wind_E = truth.wind_E.head<2>();
  wind_sum_ += now_.wind_E.norm(), ++ticks_;
  if (pilot.navigator().has_fix()) now_.since_fix = pilot.navigator().since_fix();
  if (looked != nullptr) note_sighting(pilot, *looked);
  keep_turning_points(pilot);
}

void LossWatch::keep_turning_points(const Pilot& pilot) {
  if (now_.counted <= now_.passed)
    miscounted_.reset();
  else if (!miscounted_)
    miscounted_ = now_;
  if (pilot.abort_reason() != AbortReason::kNone && !given_up_) given_up_ = now_;
}

WhyLost LossWatch::why(const Pilot& pilot, const std::string& stop_reason,
                       const std::string& contact) const {
  using How = WhyLost::How;
  const std::size_t next = static_cast<std::size_t>(now_.passed) % world_.gates.size();
  const bool at_next = contact.starts_with("gate " + std::to_string(next + 1) + " ");
  const LossMoment* moment = &now_;
  How how = stop_reason == "crash" ? How::kContact : How::kTimeout;
  if (miscounted_ && !at_next) {
    moment = &*miscounted_, how = How::kMissedGate;
  } else if (given_up_) {
    moment = &*given_up_;
    how = pilot.abort_reason() == AbortReason::kGateNotFound ? How::kNotFound : How::kGivenUp;
  }
  WhyLost why = why_lost(*moment, {world_, map_, pilot.plan()}, how, contact);
  why.reason = text_of(pilot.abort_reason());
  if (ticks_ > 0) why.wind_mean = wind_sum_ / ticks_;
  return why;
}

}  // namespace gatefly::simulated_race
