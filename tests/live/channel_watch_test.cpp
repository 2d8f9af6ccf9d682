// SPDX-License-Identifier: Apache-2.0
// Whether channels that are read back are those that were sent.
#include "gatefly/live/channel_watch.hpp"

#include <gtest/gtest.h>

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;

constexpr msp::Sticks kOne{1600, 1350, 1700, 1300}, kOther{1400, 1650, 1300, 1300};

/// Frames every 25 ms, the other way every 500 ms.
class Watched : public testing::Test {
 protected:
  static msp::Sticks sticks_at(std::chrono::milliseconds t) {
    return t / 500ms % 2 == 0 ? kOne : kOther;
  }
  /// Reads back every 80 ms what `channels` makes of the time.
  template <class Channels>
  void run(Channels&& channels) {
    for (auto t = 0ms; t < 3000ms; t += 5ms) {
      if (t % 25ms == 0ms) watch_.sent(sticks_at(t), start_ + t);
      if (t >= 200ms && t % 80ms == 0ms) watch_.read(channels(t), start_ + t);
    }
  }
  Moment start_{1h};
  ChannelWatch watch_;
};

TEST_F(Watched, ChannelsThatFollowAreWell) {
  run(sticks_at);
  EXPECT_EQ(watch_.reads(), 35);
  EXPECT_EQ(watch_.wrong(), 0);
  EXPECT_EQ(watch_.behind(), 0ms);
}

TEST_F(Watched, ADelayIsMeasuredAndTakenUpToTheLimit) {
  run([](auto t) { return sticks_at(t - 60ms); });
  EXPECT_EQ(watch_.wrong(), 0);
  EXPECT_GT(watch_.behind(), 20ms);  // as far as it is looked at just then
  EXPECT_LE(watch_.behind(), 60ms);
}

TEST_F(Watched, ALongDelayIsWrong) {
  run([](auto t) { return sticks_at(t - 300ms); });
  EXPECT_GT(watch_.wrong(), 0);
  EXPECT_EQ(watch_.not_following(), "roll and pitch and yaw");
}

TEST_F(Watched, AStepThatIsRoundedOffIsWellOnlyWhereItMayBe) {
  const auto halfway = [](std::chrono::milliseconds t) {
    return t % 500ms == 0ms && t > 0ms ? msp::Sticks{1510, 1490, 1480, 1300} : sticks_at(t - 5ms);
  };
  run(halfway);
  EXPECT_GT(watch_.wrong(), 0);
  watch_ = ChannelWatch{true};
  run(halfway);
  EXPECT_EQ(watch_.wrong(), 0);
  watch_.begin(start_ + 3s);
  watch_.sent(kOne, start_ + 3s);
  watch_.read({1650, 1490, 1480, 1300}, start_ + 3010ms);
  EXPECT_EQ(watch_.wrong(), 1) << "beyond both";
}

TEST_F(Watched, OneChannelThatStandsStillIsNamed) {
  run([](auto t) {
    msp::Sticks sticks = sticks_at(t);
    sticks.yaw = 1500;
    return sticks;
  });
  EXPECT_EQ(watch_.wrong(), watch_.reads());
  EXPECT_EQ(watch_.not_following(), "yaw");
  EXPECT_EQ(watch_.wrong_one().yaw, 1500);
}

TEST_F(Watched, ChannelsThatAreSwappedAreNamed) {
  run([](auto t) {
    msp::Sticks sticks = sticks_at(t);
    std::swap(sticks.yaw, sticks.throttle);
    return sticks;
  });
  EXPECT_NE(watch_.not_following().find("yaw"), std::string::npos);
  EXPECT_NE(watch_.not_following().find("throttle"), std::string::npos);
}

TEST_F(Watched, ChannelsOfTwoFramesAreNoFrame) {
  run([](auto t) {
    msp::Sticks sticks = sticks_at(t);
    sticks.roll = sticks_at(t + 500ms).roll;
    return sticks;
  });
  EXPECT_EQ(watch_.wrong(), watch_.reads());
  EXPECT_EQ(watch_.not_following(), "roll");
}

TEST_F(Watched, WhatWasReadBeforeItBeganDoesNotCount) {
  watch_.begin(start_ + 10s);
  run([](auto) { return msp::kNeutral; });
  EXPECT_EQ(watch_.reads(), 0);
  EXPECT_EQ(watch_.not_following(), "");
}

TEST(Sticks, AreTheSameWithinTheirNoise) {
  EXPECT_TRUE(same_sticks(kOne, {1602, 1348, 1700, 1300}, 2));
  EXPECT_FALSE(same_sticks(kOne, {1600, 1350, 1700, 1303}, 2));
  EXPECT_EQ(text_of(kOne), "roll 1600, pitch 1350, yaw 1700, throttle 1300");
}

}  // namespace
}  // namespace gatefly::live
