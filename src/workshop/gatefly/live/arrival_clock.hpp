// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

namespace gatefly::live {

/// Times of samples that arrive late by a jitter: taken regularly and without a stamp, or with one of another clock.
///
/// Ours: a sample was taken a period after the one before it, or as much as the stamps are apart, corrected by a part of how far its arrival is off; never
/// after it arrived. A pause starts it anew.
class ArrivalClock {
 public:
  explicit ArrivalClock(std::chrono::nanoseconds period) : period_{period} {}

  /// One arrives at `arrival`. @return when it was taken, but for a constant delay.
  std::chrono::nanoseconds take(std::chrono::nanoseconds arrival) { return take(arrival, period_); }
  /// The same of one that was stamped so much later than the one before.
  std::chrono::nanoseconds take(std::chrono::nanoseconds arrival, std::chrono::nanoseconds since) {
    const auto expected = last_ + since, off = arrival - expected;
    const bool paused = !started_ || off > 3 * period_ || off < -3 * period_;
    last_ = paused ? arrival : std::min(arrival, expected + off / kPart);
    started_ = true;
    return last_;
  }

 private:
  static constexpr int kPart =
      8;  ///< Part of an error that one arrival corrects. Ours: 0.16 s at 50 Hz.
  std::chrono::nanoseconds period_, last_{0};
  bool started_ = false;
};

}  // namespace gatefly::live
