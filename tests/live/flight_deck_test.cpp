// SPDX-License-Identifier: Apache-2.0
// Which sticks go to the drone, period by period.
#include "gatefly/live/flight_deck.hpp"

#include <chrono>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/config/track_file.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/live/msp_speaker.hpp"

#include "support/real_data.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

/// A healthy drone and pilot, and a deck between them.
class Flight : public testing::Test {
 protected:
  FlightDeck::Sent period() {
    now_ += kStickPeriod;
    for (nanoseconds* at :
         {&controller_.imu_at, &controller_.imu_changed_at, &controller_.attitude_at,
          &controller_.status_at, &wanted_.at, &wanted_.height_at, &wanted_.picture_at})
      if (at != stopped_) *at = now_;
    if (sent_.action != guard::Action::kSilent) ++controller_.acknowledged;
    sent_ = deck_.step(controller_, wanted_, told_, now_);
    return sent_;
  }
  FlightDeck::Sent periods(int count) {
    for (int i = 0; i < count; ++i) (void)period();
    return sent_;
  }
  void take_off() {
    (void)periods(60);
    controller_.armed = true;
    (void)periods(10);
    controller_.override_on = true;
    wanted_.steers = true;
    wanted_.p_EB = {0, 0, -1.5};
    wanted_.command.attitude.thrust = kGravity;
    (void)periods(4);
    ASSERT_EQ(deck_.state().phase, guard::Phase::kFlying);
  }

  /// The sticks of a Betaflight for what was decided.
  msp::Sticks sticks(const FlightDeck::Sent& sent) const {
    return MspSpeaker{drone_, {}}.sticks(sent.demand);
  }

  DroneFile drone_ = read_drone(support::source_folder() / "tests" / "live" / "fake_drone.toml");
  FlightDeck deck_{[] {
    FlightDeck::Params params;
    params.hand_over_tested = true;
    params.fence = {.low = {-5, -5}, .high = {5, 5}, .height = 3};
    return params;
  }()};
  ControllerState controller_;
  Wanted wanted_;
  nanoseconds now_{0};
  nanoseconds* stopped_ = nullptr;  ///< Time stamp that no longer advances.
  bool told_ = false;
  FlightDeck::Sent sent_;
};

TEST_F(Flight, SticksAreNeutralUntilTheRadioHandsOver) {
  for (int i = 0; i < 60; ++i) {
    const auto sent = period();
    EXPECT_EQ(sticks(sent), msp::kNeutral);
  }
  EXPECT_EQ(deck_.state().phase, guard::Phase::kStreaming);
  EXPECT_FALSE(deck_.ending().in_air);
}

TEST_F(Flight, ThePilotsRatesAndThrustArriveAsHeMeantThem) {
  take_off();
  wanted_.command.rates_B = {1.0, -0.5, 0.3};
  wanted_.command.attitude.thrust = 1.1 * kGravity;
  const auto sent = period();
  EXPECT_LT((drone_.rates.rates(sticks(sent)) - wanted_.command.rates_B).norm(), 0.02);
  const double throttle = drone_.throttle.throttle(sticks(sent).throttle);
  EXPECT_NEAR(std::pow(throttle / drone_.hover.throttle, drone_.hover.exponent), 1.1, 0.01);
  EXPECT_TRUE(deck_.ending().in_air);
}

TEST_F(Flight, NoseDownIsMoreOfThePitchStick) {
  take_off();
  wanted_.command.rates_B = {0, -0.5, 0};
  EXPECT_GT(sticks(period()).pitch, 1500);
}

TEST_F(Flight, OnThePadAfterTheHandOverTheMotorsRest) {
  take_off();
  wanted_.steers = false;
  EXPECT_EQ(sticks(period()), msp::kNeutral);
  EXPECT_FALSE(deck_.ending().in_air);
}

TEST_F(Flight, ALatePilotEndsItWithinThreePeriodsByBraking) {
  take_off();
  wanted_.v_E = {2, 0, 0};
  (void)period();
  stopped_ = &wanted_.at;
  (void)periods(3);
  EXPECT_EQ(sent_.action, guard::Action::kBrake);
  EXPECT_EQ(deck_.state().reason, guard::Reason::kPilotLate);
  EXPECT_LT(sticks(sent_).pitch, 1500 - 50) << "nose up, against the velocity";
  (void)periods(40);
  EXPECT_EQ(sent_.action, guard::Action::kDescend);
  EXPECT_EQ(sticks(sent_).pitch, 1500) << "level: the controller says that it is";
  EXPECT_LT(sticks(sent_).throttle, drone_.hover_stick);
}

TEST_F(Flight, PicturesThatStandStillEndIt) {
  take_off();
  wanted_.picture_limit = 2 * 33ms + 10ms;
  stopped_ = &wanted_.picture_at;
  (void)periods(4);
  EXPECT_EQ(deck_.state().reason, guard::Reason::kPicturesStale);
}

TEST_F(Flight, OutsideOfTheFenceItEnds) {
  take_off();
  wanted_.p_EB = {0, 0, -3.2};
  (void)period();
  EXPECT_EQ(deck_.state().reason, guard::Reason::kFence);
}

TEST_F(Flight, WhileNothingTellsTheHeightAPilotThatClimbsIsNotObeyed) {
  take_off();
  wanted_.command.attitude.thrust = 1.3 * kGravity;
  stopped_ = &wanted_.height_at;
  (void)periods(60);
  EXPECT_EQ(sent_.action, guard::Action::kPilot);
  EXPECT_LE(sticks(sent_).throttle, drone_.hover_stick + 1);
}

TEST_F(Flight, AnEndingIsNotTakenBackByAPilotThatIsWellAgain) {
  take_off();
  stopped_ = &wanted_.at;
  (void)periods(4);
  stopped_ = nullptr;
  (void)periods(100);
  EXPECT_EQ(sent_.action, guard::Action::kDescend);
}

TEST_F(Flight, WhenThePilotHasLandedItEndsAndIsOverOnceDisarmed) {
  take_off();
  wanted_.landed = true;
  (void)periods(2);
  EXPECT_EQ(deck_.state().phase, guard::Phase::kEnding);
  controller_.armed = false;
  (void)period();
  EXPECT_EQ(deck_.state().phase, guard::Phase::kOver);
}

TEST_F(Flight, WithoutAHandOverTestNothingIsEverSent) {
  FlightDeck untested{{}};
  for (int i = 0; i < 10; ++i) {
    now_ += kStickPeriod;
    controller_.status_at = now_;
    EXPECT_EQ(untested.step(controller_, wanted_, false, now_).action, guard::Action::kSilent);
  }
  EXPECT_EQ(untested.state().reason, guard::Reason::kNotTested);
}

TEST(FenceAround, HoldsTheCourseAndALittleMoreButNotMoreThanTheRoom) {
  Track track;
  track.gates.push_back({.p_EG = {4, -2, -1.5}});
  const Fence fence = fence_around(track, {}, 3.0, 1.5);
  EXPECT_TRUE(fence.holds({6.9, 0, -2.9}));
  EXPECT_TRUE(fence.holds({-2.9, 2.9, 0}));
  EXPECT_FALSE(fence.holds({7.1, 0, -1}));
  EXPECT_FALSE(fence.holds({0, 0, -3.1}));
  track.ceiling = 2.5;
  EXPECT_FALSE(fence_around(track, {}, 3.0, 1.5).holds({0, 0, -2.6}));
}

TEST(FenceAround, ThePlannedWayIsInsideEvenWhereItTurnsFarBehindAGate) {
  for (const char* name : {"oval", "showroom", "aigp-pq", "grandprix", "wide"}) {
    SCOPED_TRACE(name);
    const Track track = config::read_track(config::find_track(name), {}).track;
    const RacePlan plan = plan_race(track, {});
    const Fence fence = fence_around(track, plan, 3.0, 1.5);
    std::vector<Path> ways = plan.legs;
    ways.push_back(plan.start);
    for (const Path& way : ways)
      for (double s = 0.0; s < way.length(); s += 0.5) {
        const Eigen::Vector2d p = way.at(s).position;
        for (const Eigen::Vector2d& off : {Eigen::Vector2d{1.4, 0}, {-1.4, 0}, {0, 1.4}, {0, -1.4}})
          EXPECT_TRUE(fence.holds({p.x() + off.x(), p.y() + off.y(), way.z_at(s)})) << s;
      }
  }
}

}  // namespace
}  // namespace gatefly::live
