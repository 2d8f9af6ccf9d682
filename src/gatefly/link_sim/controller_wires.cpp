// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link_sim/controller_wires.hpp"

#include <algorithm>

namespace gatefly::link_sim {

void Motors::listen(double now) {
  std::array<std::uint8_t, 256> room{};
  while (const auto bytes = heard_.receive(room)) {
    const auto servos = betaflight_sitl::raw_servos_in(*bytes);
    if (!servos || servos->motors < 4) continue;
    last_ = now;
    // Betaflight counts rear right, front right, rear left, front left.
    constexpr std::array<std::size_t, 4> kTheirs{3, 1, 0, 2};
    for (std::size_t i = 0; i < 4; ++i)
      motors_[i] = std::clamp(1e-3 * (servos->pulse_us[kTheirs[i]] - 1000.0), 0.0, 1.0);
  }
  if (last_ && now - *last_ > kSilence) motors_ = {};
}

bool Motors::turn() const {
  return std::all_of(motors_.begin(), motors_.end(), [](double part) { return part > 0.0; });
}

}  // namespace gatefly::link_sim
