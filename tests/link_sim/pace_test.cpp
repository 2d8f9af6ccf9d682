// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/pace.hpp"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace gatefly::link_sim {
namespace {

using namespace std::chrono_literals;
using live::Clock;

// Only least times are asked for: a busy machine makes all of them longer.

TEST(Pace, AThousandStepsASecond) {
  Pace pace;
  const live::Moment begin = Clock::now();
  for (int i = 0; i < 21; ++i) pace.wait();
  EXPECT_GE(Clock::now() - begin, 19ms);
}

TEST(Pace, AStallIsMadeUpForByAFewStepsOnly) {
  Pace pace;
  pace.wait();
  std::this_thread::sleep_for(40ms);
  const live::Moment begin = Clock::now();
  for (int i = 0; i < 31; ++i) pace.wait();
  EXPECT_GE(Clock::now() - begin, 24ms);
  EXPECT_GE(pace.longest_stall(), 0.038);
  EXPECT_GE(pace.stood_still(), 0.038);
}

TEST(Pace, AStepNotTakenComesAMillisecondLater) {
  Pace pace;
  pace.wait();
  const live::Moment start = pace.start(), begin = Clock::now();
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(pace.every(1000)) << "still the first step";
    pace.stand_still();
    pace.wait();
  }
  EXPECT_GE(Clock::now() - begin, 9ms);
  EXPECT_GE(pace.start() - start, 10ms) << "where the steps' time is 0 moves on with the clock";
  EXPECT_GE(pace.stood_still(), 0.01);
  pace.wait();
  EXPECT_FALSE(pace.every(1000));
}

}  // namespace
}  // namespace gatefly::link_sim
