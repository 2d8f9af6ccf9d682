// SPDX-License-Identifier: Apache-2.0
// Lateness of pictures by stamps of a clock that is not ours.
#include "gatefly/live/stamped_arrivals.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/generators.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr nanoseconds kStart = 500h;  // of our clock; the other one began later

nanoseconds of(double seconds) { return nanoseconds{std::llround(1e9 * seconds)}; }

/// Pictures at `hz` for `seconds`: stamp_of and took_of tell the stamp and the way of the one exposed at a time. @return the most that one was called late.
template <class StampOf, class TookOf>
nanoseconds latest(StampedArrivals& arrivals, double from, double seconds, double hz,
                   StampOf&& stamp_of, TookOf&& took_of) {
  nanoseconds most{0};
  for (int i = 0; i < static_cast<int>(seconds * hz); ++i) {
    const nanoseconds exposed = of(from + i / hz);
    most = std::max(most, arrivals.late(kStart + exposed + took_of(exposed), stamp_of(exposed)));
  }
  return most;
}

const auto kTrue = [](nanoseconds exposed) { return exposed; };
const auto kAlways20 = [](nanoseconds) { return 20ms; };

TEST(StampedArrivals, ADelayThatAllHaveIsNotSeen) {
  StampedArrivals arrivals;
  EXPECT_EQ(latest(arrivals, 0, 60, 30, kTrue, kAlways20), 0ns);
}

TEST(StampedArrivals, JitterIsSeenToWithinTwoMilliseconds) {
  for (const double hz : {5.0, 30.0, 120.0}) {
    StampedArrivals arrivals;
    Rng rng{3};
    double squares = 0.0;
    int count = 0;
    for (int i = 0; i < static_cast<int>(60 * hz); ++i) {
      const double jitter = -0.008 * std::log(rng.uniform(1e-3, 1.0));  // as of a queue
      const nanoseconds exposed = of(i / hz);
      const nanoseconds said = arrivals.late(kStart + exposed + of(0.02 + jitter), exposed);
      if (i < 3 * hz) continue;
      const double off = std::chrono::duration<double>(said).count() - jitter;
      squares += off * off, ++count;
    }
    ASSERT_GT(count, 100);
    EXPECT_LT(std::sqrt(squares / count), hz < 10 ? 0.004 : 0.002) << hz;  // 8 ms are in it
  }
}

TEST(StampedArrivals, ASenderThatStoodIsForgottenInASecond) {
  StampedArrivals arrivals;
  (void)latest(arrivals, 0, 10, 30, kTrue, kAlways20);
  const auto behind = [](nanoseconds) { return 80ms; };
  EXPECT_EQ(latest(arrivals, 10, 1, 30, kTrue, behind), 60ms);
  EXPECT_EQ(latest(arrivals, 11.1, 20, 30, kTrue, behind), 0ns);
}

TEST(StampedArrivals, ASenderThatBeginsAnewOrJumpsAheadIsANewOne) {
  StampedArrivals arrivals;
  (void)latest(arrivals, 1000, 10, 30, kTrue, kAlways20);
  const auto anew = [](nanoseconds exposed) { return exposed - 1000s; };
  EXPECT_EQ(latest(arrivals, 1010, 10, 30, anew, kAlways20), 0ns);
  const auto ahead = [](nanoseconds exposed) { return exposed + 1h; };
  EXPECT_EQ(latest(arrivals, 1020, 10, 30, ahead, kAlways20), 0ns);
}

TEST(StampedArrivals, AClockThatGoesSlowerFasterOrNotAtAllSaysNothingFalse) {
  for (const double rate : {0.0, 1e-3, 0.5, 0.9, 0.98, 0.995, 0.999, 1.0001, 1.02, 2.0}) {
    StampedArrivals arrivals;
    const auto other = [&](nanoseconds exposed) {
      return nanoseconds{std::llround(rate * static_cast<double>(exposed.count()))};
    };
    EXPECT_LE(latest(arrivals, 0, 30, 30, other, kAlways20), 10ms) << rate;
  }
}

TEST(StampedArrivals, OneThatIsStampedFalselySpoilsASecondAtMost) {
  StampedArrivals arrivals;
  (void)latest(arrivals, 0, 10, 30, kTrue, kAlways20);
  (void)arrivals.late(kStart + 10s + 20ms, 10s + 100ms);
  (void)latest(arrivals, 10.03, 1, 30, kTrue, kAlways20);
  EXPECT_EQ(latest(arrivals, 11.1, 2.8, 30, kTrue, kAlways20), 0ns);
}

TEST(StampedArrivals, NonsenseIsNoStamp) {
  StampedArrivals arrivals;
  (void)latest(arrivals, 0, 10, 30, kTrue, kAlways20);
  for (const nanoseconds stamp : {nanoseconds{-1}, nanoseconds::min(), nanoseconds::max()})
    EXPECT_EQ(arrivals.late(kStart + 10s, stamp), 0ns);
  EXPECT_EQ(latest(arrivals, 10, 1, 30, kTrue, kAlways20), 0ns) << "and changes nothing";
}

}  // namespace
}  // namespace gatefly::live
