// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/autopilot/companion.hpp"

namespace gatefly::sim {

Companion::Companion(const world::AutopilotTruth& truth, double max_rotor_speed, std::uint64_t seed)
    : truth_{truth},
      curves_{truth},
      max_rotor_speed_{max_rotor_speed},
      line_{truth.hz, truth.delay, truth.delay_jitter, {seed, "autopilot link"}} {}

SetPoint Companion::set_point(const Wish& wish) const {
  SetPoint s;
  s.armed = wish.rotor_speed > 0.0;
  s.sticks = curves_.rates.sticks(wish.rates_B);
  if (truth_.takes == world::AutopilotTruth::Takes::kAngles) {
    s.sticks.roll = static_cast<std::uint16_t>(curves_.angle_stick(wish.roll));
    s.sticks.pitch = static_cast<std::uint16_t>(curves_.angle_stick(-wish.pitch));
  }
  s.sticks.throttle = static_cast<std::uint16_t>(
      curves_.throttle.stick(throttle_of(wish.rotor_speed, max_rotor_speed_)));
  return s;
}

const SetPoint& Companion::pass_on(const Wish& wish, double time) {
  if (line_.is_due(time)) line_.send(set_point(wish), time);
  while (const auto next = line_.arrived(time)) arrived_ = *next;
  return arrived_;
}

}  // namespace gatefly::sim
