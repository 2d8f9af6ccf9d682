// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/safety_pilot.hpp"

namespace gatefly::link_sim {

SafetyPilot::State SafetyPilot::step(const Seen& seen) {
  const double waited = seen.time - since_;
  const bool rests = seen.airborne && seen.on_floor;
  if (!rests) floor_since_ = -1.0;
  if (rests && floor_since_ < 0.0) floor_since_ = seen.time;
  switch (state_) {
    case State::kWaits:
      if (seen.client) enter(State::kGetsReady, seen.time);
      break;
    case State::kGetsReady:
      if (!seen.client)
        enter(State::kWaits, seen.time);
      else if (waited >= params_.wait)
        enter(State::kArmed, seen.time);
      break;
    case State::kArmed:
      if (waited < params_.hand_over) break;
      enter(seen.motors ? State::kHandedOver : State::kNotArmed, seen.time);
      if (seen.motors) handed_over_at_ = seen.time;
      break;
    case State::kNotArmed:
      if (waited >= params_.again) enter(State::kArmed, seen.time);
      break;
    case State::kHandedOver:
      if (seen.hit || waited >= params_.time_limit ||
          (rests && seen.time - floor_since_ >= params_.rest))
        enter(State::kTookBack, seen.time);
      break;
    case State::kTookBack:
      break;
  }
  return state_;
}

std::array<std::uint16_t, 12> switches_of(bool armed, bool override_on) {
  constexpr std::uint16_t kOff = 1000, kOn = 2000;
  std::array<std::uint16_t, 12> aux{};
  aux.fill(kOff);
  if (armed) aux[0] = kOn;
  if (override_on) aux[4] = kOn;
  return aux;
}

}  // namespace gatefly::link_sim
