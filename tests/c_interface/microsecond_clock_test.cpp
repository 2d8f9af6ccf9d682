// SPDX-License-Identifier: Apache-2.0
#include "microsecond_clock.hpp"

#include <cstdint>
#include <optional>

#include <gtest/gtest.h>

namespace gatefly::c_interface {
namespace {

constexpr std::uint32_t kTick = 1953;  // 512 Hz [µs]

TEST(MicrosecondClock, ADayOfStampsRunsOnWithoutAStepTooLong) {
  MicrosecondClock clock;
  constexpr std::uint64_t kDay = 86'400'000'000,
                          kStep = 499'999;  // seldom, so that it takes no time
  std::uint64_t expected = 7;
  for (std::uint64_t t = 7; t < kDay; t += kStep) {
    ASSERT_EQ(clock.next(static_cast<std::uint32_t>(t)), expected);
    expected += kStep;
  }
  EXPECT_EQ(clock.wraps(), kDay >> 32);
  EXPECT_EQ(clock.jumps(), 0u);
}

TEST(MicrosecondClock, ASampleAtTheWrapItselfIsTaken) {
  MicrosecondClock clock;
  EXPECT_EQ(clock.next(0xffffffffu), 0xffffffffull);
  EXPECT_EQ(clock.next(0u), 0x100000000ull);
  EXPECT_EQ(clock.next(1u), 0x100000001ull);
  EXPECT_EQ(clock.wraps(), 1u);
}

TEST(MicrosecondClock, AGapUpToHalfASecondIsAGap) {
  MicrosecondClock clock;
  EXPECT_EQ(clock.next(1'000), 1'000u);
  EXPECT_EQ(clock.next(501'000), 501'000u);
  EXPECT_EQ(clock.next(1'001'001), std::nullopt);
}

TEST(MicrosecondClock, StampsThatDoNotFollowEachOtherAreNeverFollowed) {
  MicrosecondClock clock;
  ASSERT_TRUE(clock.next(1'000));
  std::uint32_t garbage = 12345;
  for (int i = 0; i < 100; ++i) {
    garbage = garbage * 1664525u + 1013904223u;
    EXPECT_EQ(clock.next(garbage | 0x40000000u), std::nullopt);
  }
  EXPECT_EQ(clock.refused_in_a_row(), 100);
  EXPECT_EQ(clock.next(1'000 + kTick), 1'000u + kTick);
}

TEST(MicrosecondClock, AJumpIsFollowedByTheThirdAndTimeGoesOn) {
  MicrosecondClock clock;
  ASSERT_TRUE(clock.next(5'000'000));
  EXPECT_EQ(clock.next(100), std::nullopt);
  EXPECT_EQ(clock.next(100 + kTick), std::nullopt);
  EXPECT_EQ(clock.next(100 + 2 * kTick), 5'000'000u + kTick);
  EXPECT_EQ(clock.next(100 + 3 * kTick), 5'000'000u + 2 * kTick);
  EXPECT_EQ(clock.jumps(), 1u);
  EXPECT_EQ(clock.wraps(), 0u);
}

TEST(MicrosecondClock, TellsHowOldAStampOfAnotherSensorIs) {
  MicrosecondClock clock;
  EXPECT_EQ(clock.age_of(7), std::nullopt);
  ASSERT_TRUE(clock.next(0xfffffff0u));
  ASSERT_TRUE(clock.next(0x10u));
  EXPECT_EQ(clock.age_of(0xfffffff0u), 0x20);
  EXPECT_EQ(clock.age_of(0x11u), -1);
}

}  // namespace
}  // namespace gatefly::c_interface
