// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/safety_pilot.hpp"

#include <gtest/gtest.h>

namespace gatefly::link_sim {
namespace {

using State = SafetyPilot::State;

/// A person with a radio, and what there is to see; time goes on by 20 ms with every look.
class Radio : public testing::Test {
 protected:
  void looks(double seconds) {
    for (const double end = seen_.time + seconds; seen_.time < end; seen_.time += 0.02)
      pilot_.step(seen_);
  }
  void hand_over() {
    seen_.client = seen_.motors = true;
    looks(4.7);
    ASSERT_EQ(pilot_.state(), State::kHandedOver);
  }

  SafetyPilot pilot_;
  SafetyPilot::Seen seen_;
};

TEST_F(Radio, NothingIsArmedBeforeSomebodyTalksToTheController) {
  looks(60.0);
  EXPECT_EQ(pilot_.state(), State::kWaits);
  EXPECT_EQ(pilot_.switches()[0], 1000);
  seen_.client = true;
  looks(1.0);
  seen_.client = false;
  looks(60.0);
  EXPECT_EQ(pilot_.state(), State::kWaits) << "it has gone again";
}

TEST_F(Radio, ArmsFirstAndOverridesThen) {
  seen_.client = seen_.motors = true;
  looks(4.1);
  EXPECT_TRUE(pilot_.armed());
  EXPECT_FALSE(pilot_.override_on());
  EXPECT_EQ(pilot_.switches()[0], 2000);
  EXPECT_EQ(pilot_.switches()[4], 1000);
  looks(0.6);
  EXPECT_TRUE(pilot_.override_on());
  EXPECT_EQ(pilot_.switches()[4], 2000);
}

TEST_F(Radio, AControllerThatDoesNotArmIsTriedAgainAndNeverOverridden) {
  seen_.client = true;
  int tries = 0;
  bool was = false;
  for (int i = 0; i < 1000; ++i) {
    looks(0.02);
    tries += pilot_.armed() && !was;
    was = pilot_.armed();
    ASSERT_FALSE(pilot_.override_on());
  }
  EXPECT_GE(tries, 8);
  seen_.motors = true;
  looks(2.0);
  EXPECT_TRUE(pilot_.override_on());
}

TEST_F(Radio, TakesItBackWhenItHasLanded) {
  hand_over();
  looks(5.0);
  EXPECT_TRUE(pilot_.override_on()) << "on the floor, but it has not flown yet";
  seen_.airborne = true, seen_.on_floor = false;
  looks(10.0);
  seen_.on_floor = true;
  looks(0.5);
  seen_.on_floor = false;  // it jumps
  looks(0.5);
  EXPECT_TRUE(pilot_.override_on());
  seen_.on_floor = true;
  looks(1.1);
  EXPECT_EQ(pilot_.state(), State::kTookBack);
  EXPECT_FALSE(pilot_.armed());
  EXPECT_FALSE(pilot_.override_on());
}

TEST_F(Radio, TakesItBackAtOnceWhenSomethingIsHitAndAtTheEndOfItsTime) {
  hand_over();
  seen_.airborne = true, seen_.on_floor = false, seen_.hit = true;
  looks(0.02);
  EXPECT_EQ(pilot_.state(), State::kTookBack);

  pilot_ = SafetyPilot{SafetyPilot::Params{.time_limit = 10.0}};
  seen_ = {};
  hand_over();
  seen_.airborne = true, seen_.on_floor = false;
  looks(9.0);
  EXPECT_TRUE(pilot_.override_on());
  looks(1.2);
  EXPECT_EQ(pilot_.state(), State::kTookBack);
  seen_.client = false;
  looks(60.0);
  EXPECT_EQ(pilot_.state(), State::kTookBack) << "nothing leads out of it";
}

}  // namespace
}  // namespace gatefly::link_sim
