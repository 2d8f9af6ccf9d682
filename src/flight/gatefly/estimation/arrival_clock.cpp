// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/arrival_clock.hpp"

#include <algorithm>

namespace gatefly {
namespace {

// An arrival's error moves the clock, and its rate, by so much: critically damped. [estimate]
constexpr double kPhaseGain = 0.15, kRateGain = 0.012;
constexpr double kMostLate = 0.006;  // asked for late rather than late on its way [s]. [estimate]
constexpr double kFastest = 0.4, kSlowest = 4.0;  // periods, of the nominal one
constexpr int kMostLost = 50;                     // samples in a row that a gap may stand for

}  // namespace

void ArrivalClock::arrived(double time) {
  if (!time_) {
    time_ = time;
    return;
  }
  // One that is lost leaves a gap of two periods.
  const double periods = (time - *time_) / period_;
  const int steps = std::clamp(static_cast<int>(std::min(periods, 1e3) + 0.5), 1, kMostLost);
  const double expected = *time_ + steps * period_, error = time - expected;
  const double taken = std::clamp(expected + kPhaseGain * error, time - kMostLate, time);
  period_ =
      std::clamp(period_ + kRateGain * error / steps, kFastest * nominal_, kSlowest * nominal_);
  interval_ = taken - *time_;
  time_ = taken;
}

}  // namespace gatefly
