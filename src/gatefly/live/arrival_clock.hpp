// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

namespace gatefly::live {

/// Times of samples that are taken regularly, arrive late by a jitter and have no stamp.
///
/// Ours: a sample was taken a period after the one before it, corrected by a part of how far its arrival is off; never
/// after it arrived. A pause starts it anew.
class ArrivalClock {
 public:
  explicit ArrivalClock(std::chrono::nanoseconds period) : period_{period} {}

  /// One arrives at `arrival`. @return when it was taken, but for a constant delay.
  std::chrono::nanoseconds take(std::chrono::nanoseconds arrival) {
    const auto expected = last_ + period_, off = arrival - expected;
    const bool paused = !started_ || off > 3 * period_ || off < -3 * period_;
    last_ = paused ? arrival : std::min(arrival, expected + off / kPart);
    started_ = true;
    return last_;
  }

 private:
  static constexpr int kPart =
      8;  ///< Of an error that one arrival corrects. Ours: 0.16 s at 50 Hz.
  std::chrono::nanoseconds period_, last_{0};
  bool started_ = false;
};

}  // namespace gatefly::live
