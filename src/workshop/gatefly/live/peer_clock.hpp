// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "gatefly/link/mavlink_axes.hpp"

namespace gatefly::live {

/// How a peer's clock stands to ours, by its TIMESYNC answers; so that what it says can be told from what it said long ago.
///
/// Ours: an answer tells the offset within half of its round trip, so of those of the last ten to twenty seconds the quickest counts. One that
/// took longer, because a line was full, does not: it would be off by half of what it waited.
class PeerClock {
 public:
  void take(const mavlink::ClockOffset& answer, std::chrono::nanoseconds now) {
    if (!newer_ || now - since_ > kHalf) {
      older_ = newer_, newer_ = answer, since_ = now;
    } else if (answer.round_trip < newer_->round_trip) {
      newer_ = answer;
    }
  }
  /// The quickest answer of late; nullopt before the first.
  [[nodiscard]] std::optional<mavlink::ClockOffset> best() const {
    return older_ && older_->round_trip < newer_->round_trip ? older_ : newer_;
  }
  /// How long ago it was at most when the peer's clock showed `stamp`; nullopt when nobody knows, or when the stamp is of another clock.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> age(std::chrono::nanoseconds stamp,
                                                            std::chrono::nanoseconds now) const {
    const auto is = best();
    if (!is) return std::nullopt;
    const std::chrono::nanoseconds age = now - (stamp - is->offset) + is->round_trip / 2;
    if (age < -kOtherClock || age > kOtherClock) return std::nullopt;
    return std::max(age, std::chrono::nanoseconds{0});
  }

 private:
  static constexpr std::chrono::nanoseconds kHalf = std::chrono::seconds{10},
                                            kOtherClock = std::chrono::seconds{10};
  std::optional<mavlink::ClockOffset> older_, newer_;
  std::chrono::nanoseconds since_{0};
};

}  // namespace gatefly::live
