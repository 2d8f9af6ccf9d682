// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

#include "gatefly/live/clock.hpp"

namespace gatefly::link_sim {

/// Steps of a millisecond, a thousand of them a second.
class Pace {
 public:
  static constexpr std::chrono::milliseconds kStep{1};

  /// Waits until the next step is due.
  void wait() {
    const live::Moment due = start_ + steps_++ * kStep;
    std::this_thread::sleep_until(due);
    const auto behind = live::Clock::now() - due;
    longest_stall_ = std::max(longest_stall_, std::chrono::duration<double>(behind).count());
    if (behind > kMostBehind) start_ += behind;
  }
  /// When the steps' time was 0.
  [[nodiscard]] live::Moment start() const { return start_; }
  /// True in every `count`th step, the first among them.
  [[nodiscard]] bool every(long count) const { return (steps_ - 1) % count == 0; }
  /// By which a step was behind the clock [s].
  [[nodiscard]] double longest_stall() const { return longest_stall_; }

 private:
  /// More is not made up for: the flight lasts longer then.
  static constexpr std::chrono::milliseconds kMostBehind{50};
  live::Moment start_ = live::Clock::now();
  long steps_ = 0;
  double longest_stall_ = 0.0;
};

}  // namespace gatefly::link_sim
