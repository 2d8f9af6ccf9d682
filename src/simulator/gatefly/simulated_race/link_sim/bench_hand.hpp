// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>

#include "gatefly/link/msp_axes.hpp"

namespace gatefly::link_sim {

/// Deeds at a bench, with the drone in one hand and the radio in the other.
enum class Deed : std::uint8_t {
  kTurnRoll,
  kTurnPitch,
  kTurnYaw,
  kCalibrate,  ///< Throttle up, yaw left, pitch back: Betaflight takes the accelerometer for level.
  kArm,
  kOverrideOn,
  kOverrideOff,
  kDisarm
};
/// For the line that a user reads.
[[nodiscard]] std::string_view text_of(Deed deed);

/// Somebody at a bench, who does what a line asks: one that `gatefly bench-drone` writes, or a word: calibrate, turn, arm,
/// override on, override off, disarm. One thing after the other, each after a moment. Other lines are not for this one.
///
/// A state machine without a clock.
class BenchHand {
 public:
  /// Remembers what a line asks for.
  void hear(std::string_view line, double now);
  /// The deed of this moment [s], if any. @param motors  turn: the controller has armed.
  [[nodiscard]] std::optional<Deed> step(double now, bool motors);

  [[nodiscard]] bool armed() const { return armed_; }
  [[nodiscard]] bool override_on() const { return override_on_; }
  [[nodiscard]] const msp::Sticks& sticks() const { return sticks_; }

 private:
  std::deque<Deed> asked_;
  double next_ = 0.0;    ///< Not before then [s].
  double armed_at_ = 0;  ///< [s]
  msp::Sticks sticks_ = msp::kNeutral;
  bool armed_ = false, override_on_ = false, motors_seen_ = false;
};

}  // namespace gatefly::link_sim
