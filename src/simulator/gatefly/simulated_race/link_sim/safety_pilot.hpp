// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace gatefly::link_sim {

/// A radio's AUX1 … AUX12 [µs]: arming on AUX1, the override on AUX5, as in the AI Grand Prix.
[[nodiscard]] std::array<std::uint16_t, 12> switches_of(bool armed, bool override_on);

/// The person with the radio: arms, hands over, and takes the drone back when it has landed or hit something.
///
/// A state machine without a clock. The sticks stay at rest: only the switches move.
class SafetyPilot {
 public:
  /// Ours, all of them [s].
  struct Params {
    double wait = 4.0;       ///< From the first client of the controller to arming.
    double hand_over = 0.5;  ///< From arming to the override.
    double again =
        1.0;  ///< The arming switch off, when the motors do not turn, until it is on again.
    double rest = 1.0;          ///< On the floor, once it has flown, until it is disarmed.
    double time_limit = 180.0;  ///< From the override to taking it back.
  };
  /// Observations at a time [s] that does not run backwards.
  struct Seen {
    double time = 0.0;
    bool client = false;    ///< Somebody talks to the controller.
    bool motors = false;    ///< They turn: it has armed.
    bool on_floor = true;   ///< And does not move.
    bool airborne = false;  ///< Has left the floor at least once.
    bool hit = false;       ///< Something but the floor was touched in the air.
  };
  SafetyPilot() = default;
  explicit SafetyPilot(const Params& params) : params_{params} {}

  enum class State : std::uint8_t {
    kWaits,
    kGetsReady,
    kArmed,
    kNotArmed,  ///< It would not: the switch is off, and will be tried again.
    kHandedOver,
    kTookBack
  };
  State step(const Seen& seen);

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] bool armed() const {
    return state_ == State::kArmed || state_ == State::kHandedOver;
  }
  [[nodiscard]] bool override_on() const { return state_ == State::kHandedOver; }
  /// When it was handed over; meaningless before [s].
  [[nodiscard]] double handed_over_at() const { return handed_over_at_; }
  [[nodiscard]] std::array<std::uint16_t, 12> switches() const {
    return switches_of(armed(), override_on());
  }

 private:
  void enter(State state, double time) { state_ = state, since_ = time; }

  Params params_{};
  State state_ = State::kWaits;
  double since_ = 0.0, handed_over_at_ = 0.0, floor_since_ = -1.0;
};

}  // namespace gatefly::link_sim
