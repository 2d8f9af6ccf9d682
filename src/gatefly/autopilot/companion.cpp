// SPDX-License-Identifier: Apache-2.0
#include "gatefly/autopilot/companion.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly::autopilot {

Companion::Companion(const sim::AutopilotTruth& truth, double max_rotor_speed, std::uint64_t seed)
    : truth_{truth},
      curves_{truth},
      max_rotor_speed_{max_rotor_speed},
      lateness_{seed, "autopilot link"} {}

SetPoint Companion::set_point(const Wish& wish) const {
  SetPoint s;
  s.armed = wish.rotor_speed > 0.0;
  s.sticks = curves_.rates.sticks(wish.rates_B);
  if (truth_.takes == sim::AutopilotTruth::Takes::kAngles) {
    s.sticks.roll = static_cast<std::uint16_t>(curves_.angle_stick(wish.roll));
    s.sticks.pitch = static_cast<std::uint16_t>(curves_.angle_stick(-wish.pitch));
  }
  s.sticks.throttle = static_cast<std::uint16_t>(
      curves_.throttle.stick(throttle_of(wish.rotor_speed, max_rotor_speed_)));
  return s;
}

const SetPoint& Companion::pass_on(const Wish& wish, double time) {
  if (!next_ || time >= *next_) {
    next_ = next_.value_or(time) + 1.0 / truth_.hz;
    const double late = truth_.delay + std::abs(lateness_.normal_cut(truth_.delay_jitter));
    last_arrival_ = std::max(last_arrival_, time + late);
    on_their_way_.push_back({set_point(wish), last_arrival_});
  }
  while (!on_their_way_.empty() && time >= on_their_way_.front().arrival) {
    arrived_ = on_their_way_.front().set_point;
    on_their_way_.pop_front();
  }
  return arrived_;
}

}  // namespace gatefly::autopilot
