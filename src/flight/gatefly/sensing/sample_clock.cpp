// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sensing/sample_clock.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly {
namespace {

using std::chrono::nanoseconds;

constexpr double kLongestStep = 0.05;  // lost samples; beyond it the clock was set [s]. [estimate]
constexpr double kLongestPeriods = 5.0;  // the same, of an IMU slower than 100 Hz. [estimate]
constexpr double kStandsFor = 0.1;       // [s] [as of an IMU that is stuck: SensorWatch]
constexpr int kFollowing = 3;            // one or two may be out of order. [estimate]
constexpr std::int64_t kFar = 1'000'000'000'000'000'000;  // 30 years, far from what overflows [ns]

// Modulo 2^64, the shorter way round: no pair of stamps overflows.
nanoseconds step_between(nanoseconds later, nanoseconds earlier) {
  return nanoseconds{static_cast<std::int64_t>(static_cast<std::uint64_t>(later.count()) -
                                               static_cast<std::uint64_t>(earlier.count()))};
}

nanoseconds nanoseconds_of(double seconds) {
  return nanoseconds{static_cast<std::int64_t>(1e9 * seconds)};
}

}  // namespace

SampleClock::SampleClock(double nominal_hz)
    : period_{nanoseconds_of(1.0 / nominal_hz)},
      longest_{nanoseconds_of(std::max(kLongestStep, kLongestPeriods / nominal_hz))},
      stands_{static_cast<int>(std::ceil(kStandsFor * nominal_hz))} {}

SampleClock::Reading SampleClock::next(nanoseconds stamp) {
  if (!started_) {
    started_ = true;
    last_ = stamp;
    time_ = stamp.count() > -kFar && stamp.count() < kFar ? stamp : nanoseconds{0};
    return {time_, true};
  }
  const nanoseconds step = step_between(stamp, last_);
  if (step.count() > 0 && step <= longest_) return take(stamp, step);
  const bool is_far = step > longest_ || step < -longest_;
  following_ = in_a_row_ > 0 && step_between(stamp, last_refused_).count() > 0 ? following_ + 1 : 1;
  if (is_far || following_ >= kFollowing) {
    ++jumps_;
    return take(stamp, period_);
  }
  last_refused_ = stamp;
  ++refused_;
  if (in_a_row_ < stands_)
    ++in_a_row_;
  else
    time_ += period_;
  return {time_, false};
}

SampleClock::Reading SampleClock::take(nanoseconds stamp, nanoseconds step) {
  following_ = in_a_row_ = 0;
  last_ = stamp;
  time_ += step;
  return {time_, true};
}

}  // namespace gatefly
