// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/controller.hpp"

#include <array>
#include <chrono>

#include <gtest/gtest.h>

namespace gatefly::link_sim {
namespace {

using namespace std::chrono_literals;

/// One that answers when the test says so.
class Played : public Controller {
 public:
  void listen(double) override {}
  void feel(const betaflight_sitl::State&, const sim::BodyState&) override {}
  void hear_radio(std::chrono::nanoseconds, const msp::Sticks&,
                  const std::array<std::uint16_t, 12>&) override {}
  void answers(float pulse_us) {
    told<float>(std::array{pulse_us, pulse_us, pulse_us, pulse_us}, {0, 1, 2, 3}, 0.0);
  }
  void is_asked(live::Moment at) { asked(at); }
};

class ControllerThatOwes : public testing::Test {
 protected:
  void is_asked(int times) {
    for (int i = 0; i < times; ++i) controller_.is_asked(now_ + i * 1ms);
  }
  Played controller_;
  live::Moment now_ = live::Clock::now();
};

TEST_F(ControllerThatOwes, LagsFromTheThirdStepOn) {
  controller_.answers(1400.0F);
  EXPECT_FALSE(controller_.lags(now_ + 50ms)) << "nobody has asked it";
  is_asked(2);
  EXPECT_FALSE(controller_.lags(now_ + 50ms))
      << "the world is a step ahead, or two, however long that takes";
  is_asked(1);
  EXPECT_TRUE(controller_.lags(now_)) << "steps that are made up for at once count, too";
  EXPECT_EQ(controller_.silence(now_ + 6ms), 6ms);
  controller_.answers(1400.0F);
  EXPECT_FALSE(controller_.lags(now_ + 6ms)) << "one answer is one for all";
  EXPECT_EQ(controller_.silence(now_ + 6ms), 0ns);
}

TEST_F(ControllerThatOwes, MayBeOneThatAnswersEveryFourthStep) {
  for (int i = 0; i < 1000; ++i) {
    controller_.answers(1000.0F);
    is_asked(4);
  }
  controller_.answers(1400.0F);
  is_asked(7);
  EXPECT_FALSE(controller_.lags(now_ + 10ms));
  is_asked(1);
  EXPECT_TRUE(controller_.lags(now_ + 10ms));
}

TEST_F(ControllerThatOwes, IsNotWaitedForWhenItIsGone) {
  controller_.answers(1400.0F);
  is_asked(3);
  EXPECT_TRUE(controller_.lags(now_ + 99ms));
  EXPECT_FALSE(controller_.lags(now_ + 101ms)) << "it has died: the drone falls";
}

TEST_F(ControllerThatOwes, IsNotWaitedForOnTheGround) {
  is_asked(3);
  EXPECT_FALSE(controller_.lags(now_ + 20ms)) << "it has not armed";
  controller_.answers(1000.0F);
  is_asked(3);
  EXPECT_FALSE(controller_.lags(now_ + 20ms)) << "its motors stand";
}

}  // namespace
}  // namespace gatefly::link_sim
