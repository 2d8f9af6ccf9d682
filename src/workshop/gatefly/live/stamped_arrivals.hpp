// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

namespace gatefly::live {

/// How late something stamped by another clock came, against the quickest of late.
///
/// Ours. The quickest tells at once how the clocks stand; then it is forgotten by a part of each later one's lateness, because clocks drift and a
/// simulator stops now and then. The delay that all of them have cannot be told from the clocks' offset: for pictures it is the camera's latency, which the
/// calibration knows and the filter corrects.
class StampedArrivals {
 public:
  /// One arrives at `arrival` that the other clock stamped `stamp`. @return 0 or more; 0 when it begins anew, because the clocks have jumped.
  std::chrono::nanoseconds late(std::chrono::nanoseconds arrival, std::chrono::nanoseconds stamp) {
    const std::chrono::nanoseconds took = arrival - stamp;
    if (!quickest_ || took < *quickest_ || took > *quickest_ + kJump) {
      quickest_ = took;
      return std::chrono::nanoseconds{0};
    }
    const std::chrono::nanoseconds late = took - *quickest_;
    *quickest_ += late / kForgets;
    return late;
  }

 private:
  static constexpr int kForgets =
      64;  ///< Ours: a jump of clocks is over in 4 s at 30 Hz; a drift of 0.1 % makes 2 ms.
  /// Nothing comes that late. Ours: what a filter remembers of a second.
  static constexpr std::chrono::nanoseconds kJump = std::chrono::milliseconds{150};
  std::optional<std::chrono::nanoseconds> quickest_;
};

}  // namespace gatefly::live
