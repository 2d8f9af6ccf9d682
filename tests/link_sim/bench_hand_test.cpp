// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/bench_hand.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/live/bench.hpp"
#include "gatefly/live/hand_over_bench.hpp"

namespace gatefly::link_sim {
namespace {

/// Somebody at a bench, whose controller arms unless told otherwise; time goes on by 20 ms with every look.
class Bench : public testing::Test {
 protected:
  void ask(std::string_view prompt) {
    std::string line{live::kBenchSays};
    line.append(prompt);
    hand_.hear(line, t_);
  }
  /// Deeds done in so many seconds.
  std::vector<Deed> done_in(double seconds) {
    std::vector<Deed> done;
    for (const double end = t_ + seconds; t_ < end; t_ += 0.02)
      if (const auto deed = hand_.step(t_, hand_.armed() && controller_arms_))
        done.push_back(*deed);
    return done;
  }

  BenchHand hand_;
  double t_ = 0.0;
  bool controller_arms_ = true;
};
using Done = std::vector<Deed>;

TEST_F(Bench, DoesWhatTheHandOverTestAsksForAfterAMoment) {
  ask(live::at_radio::kArm);
  EXPECT_EQ(done_in(0.2), Done{});
  EXPECT_EQ(done_in(0.2), Done{Deed::kArm});
  EXPECT_TRUE(hand_.armed() && !hand_.override_on());
  ask(live::at_radio::kOverrideOn);
  EXPECT_EQ(done_in(1), Done{Deed::kOverrideOn});
  ask(live::at_radio::kOverrideOff);
  EXPECT_EQ(done_in(1), Done{Deed::kOverrideOff});
  ask(live::at_radio::kOverrideOnAgain);
  EXPECT_EQ(done_in(1), Done{Deed::kOverrideOn});
  ask(live::at_radio::kBothOff);
  EXPECT_EQ(done_in(1), (Done{Deed::kOverrideOff, Deed::kDisarm}));
  ask(live::at_radio::kDisarm);
  EXPECT_EQ(done_in(1), Done{Deed::kDisarm});
  EXPECT_FALSE(hand_.armed() || hand_.override_on());
}

TEST_F(Bench, TurnsAboutEachAxisOnceHoweverOftenItIsAskedMeanwhile) {
  for (int i = 0; i < 4; ++i) {
    ask(live::kTurnPrompt);
    const Done done = done_in(1.0);
    EXPECT_LE(done.size(), 1u);
  }
  EXPECT_EQ(done_in(4.0), (Done{Deed::kTurnYaw}));
  ask(live::kTurnPrompt);
  EXPECT_EQ(done_in(8.0), (Done{Deed::kTurnRoll, Deed::kTurnPitch, Deed::kTurnYaw}))
      << "still asked";
}

TEST_F(Bench, WordsDoTheSameAndOtherLinesNothing) {
  for (const char* word : {"arm", "override on", "override off", "disarm"}) hand_.hear(word, t_);
  EXPECT_EQ(done_in(2), (Done{Deed::kArm, Deed::kOverrideOn, Deed::kOverrideOff, Deed::kDisarm}));
  for (const char* line : {"", "Arm", "arm it",
                           "WRONG  for 60 s the controller has not seen this at the radio: disarm",
                           "well   override off: the channels are the radio's",
                           "gatefly bench-drone: ", "gatefly bench-drone: the motors will turn",
                           "gatefly bench-drone: arm"})
    hand_.hear(line, t_);
  EXPECT_EQ(done_in(5), Done{});
}

TEST_F(Bench, CalibratingMovesTheSticksForASecondAndNothingElseDoes) {
  hand_.hear("calibrate", t_);
  EXPECT_EQ(done_in(0.5), Done{Deed::kCalibrate});
  EXPECT_EQ(hand_.sticks().throttle, 2000);
  EXPECT_FALSE(hand_.armed());
  ask(live::at_radio::kArm);
  (void)done_in(1.2);
  EXPECT_EQ(hand_.sticks(), msp::kNeutral);
  EXPECT_TRUE(hand_.armed());
}

TEST_F(Bench, AControllerThatDoesNotArmIsAskedAgain) {
  controller_arms_ = false;
  ask(live::at_radio::kArm);
  int armings = 0;
  for (const Deed deed : done_in(5)) armings += deed == Deed::kArm;
  EXPECT_GE(armings, 2);
  controller_arms_ = true;
  (void)done_in(2);
  EXPECT_TRUE(hand_.armed());
  controller_arms_ = false;  // stopped by its controller later
  EXPECT_EQ(done_in(5), Done{}) << "it has armed once";
}

}  // namespace
}  // namespace gatefly::link_sim
