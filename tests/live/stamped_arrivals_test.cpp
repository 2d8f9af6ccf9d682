// SPDX-License-Identifier: Apache-2.0
// What the stamps of a clock that is not ours tell of lateness.
#include "gatefly/live/stamped_arrivals.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/generators.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr nanoseconds kPeriod = 33ms, kOtherClock = 1234h;

nanoseconds of(double seconds) { return nanoseconds{std::llround(1e9 * seconds)}; }

TEST(StampedArrivals, WhatAllHaveIsNotSeen) {
  StampedArrivals arrivals;
  for (int i = 0; i < 100; ++i)
    EXPECT_EQ(arrivals.late(i * kPeriod + 20ms, i * kPeriod - kOtherClock), 0ns) << i;
}

TEST(StampedArrivals, JitterIsSeenToWithinTwoMilliseconds) {
  StampedArrivals arrivals;
  Rng rng{3};
  double squares = 0.0;
  int count = 0;
  for (int i = 0; i < 3000; ++i) {
    const double jitter = -0.008 * std::log(rng.uniform(1e-6, 1.0));  // as of a queue
    const nanoseconds said = arrivals.late(i * kPeriod + of(0.02 + jitter), i * kPeriod);
    if (i < 60 || jitter > 0.1) continue;
    const double off = std::chrono::duration<double>(said).count() - jitter;
    squares += off * off, ++count;
  }
  EXPECT_LT(std::sqrt(squares / count), 0.002);  // 8 ms are in it
}

TEST(StampedArrivals, AClockThatJumpsForwardsBeginsAnewAndBackwardsIsForgotten) {
  StampedArrivals arrivals;
  for (int i = 0; i < 100; ++i) (void)arrivals.late(i * kPeriod, i * kPeriod);
  // A simulator stood for 60 ms: everything seems late, but not for long.
  nanoseconds late{0};
  for (int i = 100; i < 350; ++i) late = arrivals.late(i * kPeriod + 60ms, i * kPeriod);
  EXPECT_LT(late, 2ms);
  EXPECT_EQ(arrivals.late(350 * kPeriod, 352 * kPeriod), 0ns) << "the other clock jumped ahead";
  EXPECT_EQ(arrivals.late(352 * kPeriod + 5s, 353 * kPeriod), 0ns) << "it began from 0 again";
}

TEST(StampedArrivals, AClockThatGoesWrongByAThousandthIsFollowed) {
  StampedArrivals arrivals;
  for (int i = 0; i < 20000; ++i)
    EXPECT_LT(arrivals.late(i * kPeriod + i * kPeriod / 1000, i * kPeriod), 3ms) << i;
}

}  // namespace
}  // namespace gatefly::live
