// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "gatefly/sim/random.hpp"

namespace gatefly::sim {

/// A data line: messages leave at a fixed rate and arrive in order, each a little late.
template <class Message>
class LateLine {
 public:
  /// @param delay,jitter  least time on the way, and one sigma of a half normal on top of it [s].
  LateLine(double hz, double delay, double jitter, Stream lateness)
      : period_{1.0 / hz}, delay_{delay}, jitter_{jitter}, lateness_{std::move(lateness)} {}

  /// Whether it is time for the next message.
  [[nodiscard]] bool is_due(double time) const { return !next_ || time >= *next_; }

  /// Sends the message that is due at `time` [s].
  void send(const Message& message, double time) {
    next_ = next_.value_or(time) + period_;
    last_arrival_ =
        std::max(last_arrival_, time + delay_ + std::abs(lateness_.normal_cut(jitter_)));
    on_their_way_.push_back({message, last_arrival_});
  }

  /// The oldest message that has arrived and was not taken yet.
  [[nodiscard]] std::optional<Message> arrived(double time) {
    if (on_their_way_.empty() || time < on_their_way_.front().arrival) return std::nullopt;
    const Message message = on_their_way_.front().message;
    on_their_way_.pop_front();
    return message;
  }

 private:
  struct Sent {
    Message message;
    double arrival;  ///< [s]
  };

  double period_, delay_, jitter_;  ///< [s]
  Stream lateness_;
  std::optional<double> next_;  ///< When the next message is due [s].
  double last_arrival_ = 0.0;   ///< [s]
  std::deque<Sent> on_their_way_;
};

}  // namespace gatefly::sim
