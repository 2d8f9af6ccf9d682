// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sensing/sample_clock.hpp"

#include <chrono>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace gatefly {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr nanoseconds kTick{2'000'000};  // 500 Hz

// The time after these stamps.
nanoseconds time_after(SampleClock& clock, const std::vector<nanoseconds>& stamps) {
  nanoseconds time{0};
  for (const nanoseconds stamp : stamps) time = clock.next(stamp).time;
  return time;
}

TEST(SampleClock, StampsThatOnlyGoOnAreTheTime) {
  SampleClock clock{500.0};
  nanoseconds stamp{123'456'789};
  for (int i = 0; i < 1000; ++i, stamp += nanoseconds{700'000 + 9'973 * (i % 300)}) {
    const auto reading = clock.next(stamp);
    EXPECT_TRUE(reading.taken);
    EXPECT_EQ(reading.time, stamp);
  }
  EXPECT_EQ(clock.jumps() + clock.refused(), 0u);
}

TEST(SampleClock, AJumpIsAnOffsetFromThenOn) {
  for (const nanoseconds jump : {nanoseconds{100ms}, nanoseconds{-100ms}, nanoseconds{10s},
                                 nanoseconds{-10s}, nanoseconds{60ms}}) {
    SampleClock clock{500.0};
    EXPECT_EQ(time_after(clock, {1s, 1s + kTick}), 1s + kTick);
    const auto after = clock.next(1s + 2 * kTick + jump);
    EXPECT_TRUE(after.taken);
    EXPECT_EQ(after.time, 1s + 2 * kTick);
    EXPECT_EQ(clock.next(1s + 3 * kTick + jump).time, 1s + 3 * kTick);
    EXPECT_EQ(clock.jumps(), 1u);
  }
}

TEST(SampleClock, SamplesThatWereLostAreTimeThatPassed) {
  SampleClock clock{500.0}, slow{50.0};
  EXPECT_EQ(time_after(clock, {1s, 1s + 49ms}), 1s + 49ms);
  EXPECT_EQ(time_after(slow, {1s, 1s + 99ms}), 1s + 99ms);
  EXPECT_EQ(clock.jumps() + slow.jumps(), 0u);
}

TEST(SampleClock, DuplicatesAndOldSamplesAreRefused) {
  SampleClock clock{500.0};
  (void)time_after(clock, {1s, 1s + kTick});
  for (const nanoseconds stamp : {nanoseconds{1s} + kTick, nanoseconds{1s}, 1s + kTick}) {
    const auto reading = clock.next(stamp);
    EXPECT_FALSE(reading.taken);
    EXPECT_EQ(reading.time, 1s + kTick);
  }
  EXPECT_TRUE(clock.next(1s + 2 * kTick).taken);
  EXPECT_EQ(clock.refused(), 3u);
  EXPECT_EQ(clock.jumps(), 0u);
}

TEST(SampleClock, OneStampOfGarbageCostsNoTime) {
  SampleClock clock{500.0};
  EXPECT_EQ(time_after(clock, {1s, 1s + kTick, 77s, 1s + 3 * kTick}), 1s + 3 * kTick);
}

TEST(SampleClock, AClockSetBackByLittleIsFollowedOnceStampsFollowEachOther) {
  SampleClock clock{500.0};
  (void)time_after(clock, {1s, 1s + kTick});
  const nanoseconds back{-30ms};
  EXPECT_FALSE(clock.next(1s + 2 * kTick + back).taken);
  EXPECT_FALSE(clock.next(1s + 3 * kTick + back).taken);
  EXPECT_TRUE(clock.next(1s + 4 * kTick + back).taken);
  EXPECT_EQ(clock.jumps(), 1u);
}

TEST(SampleClock, WhereItStandsTimePassesSoThatSomebodyNotices) {
  SampleClock clock{500.0};
  for (int i = 0; i < 51; ++i) EXPECT_EQ(clock.next(1s).time, 1s) << i;
  nanoseconds time{1s};
  for (int i = 0; i < 100; ++i) {
    const auto reading = clock.next(1s);
    EXPECT_FALSE(reading.taken);
    EXPECT_EQ(reading.time, time += kTick);
  }
}

TEST(SampleClock, NoStampsMakeItRunBackOrOverflow) {
  constexpr auto kLeast = std::numeric_limits<std::int64_t>::min(),
                 kMost = std::numeric_limits<std::int64_t>::max();
  const std::int64_t nasty[] = {kLeast, kMost, 0, -1, 1, kMost - 1, kLeast + 1, 1'000'000'000};
  for (const std::int64_t first : nasty) {
    SampleClock clock{500.0};
    nanoseconds last = clock.next(nanoseconds{first}).time;
    for (int i = 0; i < 64; ++i) {
      const nanoseconds time = clock.next(nanoseconds{nasty[(i * i + i / 8) % 8]}).time;
      EXPECT_GE(time, last);
      EXPECT_LE(time - last, 50ms);
      last = time;
    }
  }
}

}  // namespace
}  // namespace gatefly
