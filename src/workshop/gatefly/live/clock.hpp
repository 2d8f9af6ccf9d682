// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace gatefly::live {

using Clock = std::chrono::steady_clock;
using Moment = Clock::time_point;

/// Time of a run: nanoseconds since it began, as every stamp has it.
class RunClock {
 public:
  explicit RunClock(Moment start = Clock::now()) : start_{start} {}
  [[nodiscard]] std::chrono::nanoseconds now() const { return Clock::now() - start_; }
  [[nodiscard]] Moment moment(std::chrono::nanoseconds time) const {
    return start_ + std::chrono::duration_cast<Clock::duration>(time);
  }

 private:
  Moment start_;
};

}  // namespace gatefly::live
