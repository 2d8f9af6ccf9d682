// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/phase.hpp"

#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/for_all.hpp"

namespace gatefly {
namespace {

const PhaseParams kParams;

template <class P>
bool is(const Transition& t) {
  return std::holds_alternative<P>(t.phase);
}

Situation flying() {
  Situation s;
  s.time = 10, s.rest_samples = 800, s.height = 1.5, s.gate_x = -3, s.lateral_sigma = 0.05,
  s.speed = 1.5, s.since_fix = 0.1;
  return s;
}

TEST(Phase, TakesOffOnlyAfterItsRest) {
  Situation s;
  s.rest_samples = kParams.rest_samples - 1;
  EXPECT_TRUE(is<OnGround>(next_phase(OnGround{}, s, kParams)));
  s.rest_samples = kParams.rest_samples;
  s.time = 2.5;
  const Transition t = next_phase(OnGround{}, s, kParams);
  ASSERT_TRUE(is<TakeOff>(t));
  EXPECT_EQ(std::get<TakeOff>(t.phase).since, 2.5);
}

TEST(Phase, WhenSomebodyElseHasTakenOffTheRestIsOver) {
  Situation s;
  s.lifted = true;
  EXPECT_TRUE(is<TakeOff>(next_phase(OnGround{}, s, kParams)));
  EXPECT_TRUE(is<Landed>(next_phase(Landed{}, s, kParams))) << "not again";
}

TEST(Phase, FliesForwardOnceHighEnoughAndGivesUpWhenItDoesNotClimb) {
  Situation s = flying();
  s.height = kParams.go_height - 0.01;
  EXPECT_TRUE(is<TakeOff>(next_phase(TakeOff{9.0}, s, kParams)));
  s.height = kParams.go_height + 0.01;
  EXPECT_TRUE(is<Straight>(next_phase(TakeOff{9.0}, s, kParams)));
  s.height = 0.1;
  s.time = 9.0 + kParams.climb_timeout + 0.1;
  const Transition t = next_phase(TakeOff{9.0}, s, kParams);
  EXPECT_TRUE(is<Land>(t));
  EXPECT_EQ(t.reason, AbortReason::kNoClimb);
}

TEST(Phase, WaitsAboveThePadForAFirstGateThatShouldShow) {
  Situation s = flying();
  s.gate_expected = true, s.since_fix = 1e3;
  const Transition waits = next_phase(TakeOff{3.0}, s, kParams);
  ASSERT_TRUE(is<TakeOff>(waits)) << "however long it has climbed";
  EXPECT_EQ(std::get<TakeOff>(waits.phase).since, 3.0);
  EXPECT_EQ(std::get<TakeOff>(waits.phase).waits_since.value_or(-1.0), 10.0);
  s.time = 10.0 + kParams.first_gate_timeout - 0.1;
  ASSERT_TRUE(is<TakeOff>(next_phase(waits.phase, s, kParams)));
  EXPECT_EQ(std::get<TakeOff>(next_phase(waits.phase, s, kParams).phase).waits_since.value_or(-1.0),
            10.0);
  const auto goes = [&](const Situation& now, const PhaseParams& params = kParams) {
    return is<Straight>(next_phase(waits.phase, now, params));
  };
  Situation other = s;
  other.since_fix = kParams.seen_at_start - 0.1;
  EXPECT_TRUE(goes(other)) << "it shows";
  other = s, other.gate_expected = false;
  EXPECT_TRUE(goes(other)) << "it cannot show from here";
  other = s, other.picture_interval = kParams.lost_pictures + 0.1;
  EXPECT_TRUE(goes(other)) << "a camera that shows it too seldom";
  PhaseParams params = kParams;
  params.goes_around = false;
  EXPECT_TRUE(goes(s, params)) << "as the paper flies";
  params = kParams, params.first_gate_timeout = 0.0;
  EXPECT_TRUE(goes(s, params)) << "told not to wait";
  s.time = 10.0 + kParams.first_gate_timeout + 0.1;
  const Transition t = next_phase(waits.phase, s, kParams);
  ASSERT_TRUE(is<Land>(t));
  EXPECT_TRUE(std::get<Land>(t.phase).in_a_hurry) << "it drifts while it waits";
  EXPECT_EQ(t.reason, AbortReason::kGateNotFound);
}

TEST(Phase, TurnsWhereThePathCurvesAndTheArcKeepsItsPrediction) {
  Situation s = flying();
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams)));
  s.turn_ahead = true;
  EXPECT_TRUE(is<Turn>(next_phase(Straight{}, s, kParams)));
  Turn turning;
  turning.arc.yaw = 1.25;
  const Transition t = next_phase(turning, s, kParams);
  ASSERT_TRUE(is<Turn>(t));
  EXPECT_EQ(std::get<Turn>(t.phase).arc.yaw, 1.25);
  s.turn_ahead = false;
  EXPECT_TRUE(is<Straight>(next_phase(turning, s, kParams)));
}

TEST(Phase, SearchesWhenTheGateIsNearAndUncertain) {
  Situation s = flying();
  s.gate_x = -kParams.search_before + 0.05;
  s.to_go = -s.gate_x;
  s.since_fix = 2.0;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams))) << "unseen, but known well enough";
  s.lateral_sigma = kParams.max_lateral_sigma + 0.1;
  EXPECT_TRUE(is<Search>(next_phase(Straight{}, s, kParams)));
  s.since_fix = 0.05;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams))) << "just seen";
  s.since_fix = 2.0;
  s.since_gate = 0.2;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams))) << "no time to see it yet";
  s.since_gate = 2.0;
  s.room_before = 1.4;
  EXPECT_EQ(std::get<Search>(next_phase(Straight{}, s, kParams).phase).gate_x, -1.4)
      << "waits where there is room";
  s.room_before = 2.3;
  EXPECT_EQ(std::get<Search>(next_phase(Straight{}, s, kParams).phase).gate_x, -2.2)
      << "not close to what ends the room";
  s.to_go = 6.0;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams)))
      << "on a turn that leads past the gate's plane first";
  s.to_go = 4.0;
  s.gate_x = -4;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams))) << "still far";
}

TEST(Phase, ResumesWhenTheGateIsFoundAndGivesUpWhenItIsNot) {
  Situation s = flying();
  s.gate_x = -2.3, s.since_fix = 0.1, s.speed = 0.2, s.lateral_sigma = 0.05, s.gate_y = 0.1;
  EXPECT_TRUE(is<Straight>(next_phase(Search{9.0}, s, kParams)));
  s.since_fix = 5;
  EXPECT_TRUE(is<Search>(next_phase(Search{9.0}, s, kParams)));
  s.shows_whole = false;
  EXPECT_TRUE(is<Straight>(next_phase(Search{9.0}, s, kParams))) << "others told where it is";
  s.shows_whole = true;
  s.time = 9.0 + kParams.search_timeout + 0.1;
  const Transition t = next_phase(Search{9.0}, s, kParams);
  ASSERT_TRUE(is<Land>(t));
  EXPECT_TRUE(std::get<Land>(t.phase).in_a_hurry) << "where it is grows less certain";
  EXPECT_EQ(t.reason, AbortReason::kGateNotFound);
}

// Nothing has told where it is for so long that it may be as far aside as what stands there.
TEST(Phase, StandsAndTurnsRoundWhereThePlaceIsTooUncertainForTheRoom) {
  Situation s = flying();
  s.p_EB = {4, 2}, s.v_E = {1.5, 0}, s.yaw = 0.3;
  s.room_beside = 0.9, s.drift_sigma = 0.5;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams)));
  s.drift_sigma = 0.6;
  const Transition t = next_phase(Straight{}, s, kParams);
  ASSERT_TRUE(is<Search>(t));
  const Search& stand = std::get<Search>(t.phase);
  ASSERT_TRUE(stand.stand_at.has_value());
  EXPECT_NEAR(stand.stand_at->x(), 4.0 + 1.5 * kParams.stops_within, 1e-9) << "where it can stop";
  EXPECT_NEAR(stand.stand_at->y(), 2.0, 1e-9);
  EXPECT_EQ(stand.yaw, 0.3);
  EXPECT_EQ(stand.rate, kParams.turn_rate);
  Situation rare = s;
  rare.picture_interval = 0.5;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, rare, kParams)))
      << "a turn would show it nothing";
  EXPECT_TRUE(is<Search>(next_phase(stand, s, kParams)));
  Situation before_stop = s;
  before_stop.to_stop = 1.0;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, before_stop, kParams)))
      << "it stands and turns there anyway";
  Situation told = s;
  told.drift_sigma = 0.15, told.time = s.time + 3;
  EXPECT_TRUE(is<Straight>(next_phase(stand, told, kParams))) << "goes on along its way";
  s.time += kParams.turns * 2 * kPi / kParams.turn_rate + 0.1;
  const Transition given_up = next_phase(stand, s, kParams);
  ASSERT_TRUE(is<Land>(given_up));
  EXPECT_TRUE(std::get<Land>(given_up.phase).in_a_hurry);
  EXPECT_EQ(given_up.reason, AbortReason::kGateNotFound);
  s.room_beside = 3.0;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams))) << "with room enough it flies on";
  s.room_beside = 0.1, s.drift_sigma = 0.4;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams))) << "narrow, and known well enough";
}

// Waiting before a gate that is not there is no safer than flying on without having seen it.
TEST(Phase, ASearchThatDriftsTooFarTurnsRoundAndGoesBackToItsPlace) {
  Situation s = flying();
  s.room_beside = 1.0, s.since_fix = 4.0, s.lateral_sigma = 0.6, s.gate_x = -1.9;
  const Search waiting{9.0, -2.4};
  const auto stands = [&](const Situation& now, const PhaseParams& params) {
    const Transition t = next_phase(waiting, now, params);
    return is<Search>(t) && std::get<Search>(t.phase).stand_at.has_value();
  };
  const double lost = kParams.lost_part * s.room_beside;
  s.drift_sigma = lost - 0.01;
  EXPECT_FALSE(stands(s, kParams)) << "still certain enough";
  s.drift_sigma = lost + 0.01;
  EXPECT_TRUE(stands(s, kParams)) << "another gate may tell where it is";
  Situation rare = s, before_stop = s;
  rare.picture_interval = 0.5, before_stop.to_stop = 1.0;
  EXPECT_FALSE(stands(rare, kParams)) << "a turn would pass over the gates";
  EXPECT_FALSE(stands(before_stop, kParams));
  PhaseParams of_paper = kParams;
  of_paper.goes_around = false;
  EXPECT_FALSE(stands(s, of_paper));

  const Phase stand = next_phase(waiting, s, kParams).phase;
  s.time += 3.0, s.drift_sigma = 0.1;
  const Transition back = next_phase(stand, s, kParams);
  ASSERT_TRUE(is<Search>(back));
  const Search& again = std::get<Search>(back.phase);
  EXPECT_FALSE(again.stand_at);
  EXPECT_EQ(again.gate_x, -2.4);
  EXPECT_EQ(again.since, 9.0) << "or it would search for ever";
  s.time = 9.0 + kParams.search_timeout + 0.1;
  EXPECT_TRUE(is<Land>(next_phase(again, s, kParams)));
}

TEST(Phase, AStandThatDriftsOnLandsAtOnce) {
  Situation s = flying();
  s.room_beside = 1.0;
  const double lost = kParams.lost_part * s.room_beside;
  s.drift_sigma = lost + 0.01;
  const Phase stand = next_phase(Straight{}, s, kParams).phase;
  ASSERT_TRUE(std::get<Search>(stand).stand_at);
  s.drift_sigma = kParams.hopeless * (lost + 0.01) - 0.01;
  EXPECT_TRUE(is<Search>(next_phase(stand, s, kParams)));
  s.drift_sigma += 0.02;
  const Transition down = next_phase(stand, s, kParams);
  ASSERT_TRUE(is<Land>(down));
  EXPECT_TRUE(std::get<Land>(down.phase).in_a_hurry) << "it drifts while it sinks, too";
  EXPECT_EQ(down.reason, AbortReason::kGateNotFound);
  Situation doubted = s, rare = s;
  doubted.since_doubt = 0.5, rare.picture_interval = 0.5;
  EXPECT_TRUE(is<Search>(next_phase(stand, doubted, kParams))) << "gates are in view";
  EXPECT_TRUE(is<Search>(next_phase(stand, rare, kParams)))
      << "it sees seldom, and is not yet lost";
}

// Where there is less room all at once, it has a look round first.
TEST(Phase, AStandThatBeganWithALargeDriftIsGivenItsTurn) {
  Situation s = flying();
  s.room_beside = 0.3, s.drift_sigma = 2.0;
  const Phase stand = next_phase(Straight{}, s, kParams).phase;
  ASSERT_TRUE(is<Search>(next_phase(Straight{}, s, kParams)));
  s.time += 0.01;
  EXPECT_TRUE(is<Search>(next_phase(stand, s, kParams)));
}

TEST(Phase, FoundAgainNearTheGateItHasToBeNearTheAxis) {
  Situation s = flying();
  s.speed = 0.2, s.gate_y = 0.35;
  s.gate_x = -2.2;
  EXPECT_TRUE(is<Straight>(next_phase(Search{9.0}, s, kParams)));
  s.gate_x = -1.4;
  EXPECT_TRUE(is<Search>(next_phase(Search{9.0}, s, kParams)));
  s.gate_y = 0.2;
  EXPECT_TRUE(is<Straight>(next_phase(Search{9.0}, s, kParams)));
}

TEST(Phase, EveryFlyingPhaseEndsWhenTheCourseIsDoneOrTheImuIsSilent) {
  const std::vector<Phase> all{TakeOff{9.0}, Straight{}, Turn{}, Search{9.0}};
  for (const Phase& phase : all) {
    Situation done = flying();
    done.course_done = true;
    EXPECT_TRUE(is<Land>(next_phase(phase, done, kParams))) << name_of(phase);
    EXPECT_EQ(next_phase(phase, done, kParams).reason, AbortReason::kNone);
    Situation silent = flying();
    silent.since_imu = kParams.imu_timeout + 0.01;
    EXPECT_TRUE(is<Landed>(next_phase(phase, silent, kParams))) << name_of(phase);
    EXPECT_EQ(next_phase(phase, silent, kParams).reason, AbortReason::kSensorsLost);
  }
}

TEST(Phase, MotorsGoOffWheneverItTipsOverInTheAirEvenWhileLanding) {
  const std::vector<Phase> all{TakeOff{9.0}, Straight{}, Turn{}, Search{9.0}, Land{9.5}};
  for (const Phase& phase : all) {
    Situation s = flying();
    s.tilt = kParams.max_tilt + 0.1;
    const Transition t = next_phase(phase, s, kParams);
    EXPECT_TRUE(is<Landed>(t)) << name_of(phase);
    EXPECT_EQ(t.reason, AbortReason::kUpset) << name_of(phase);
  }
}

TEST(Phase, LandingEndsOnTheFloorOrAfterAWhileAndForGood) {
  Situation s = flying();
  EXPECT_TRUE(is<Land>(next_phase(Land{9.0}, s, kParams)));
  s.height = 0.05;
  EXPECT_TRUE(is<Landed>(next_phase(Land{9.0}, s, kParams)));
  s.height = 1.5, s.time = 60;
  EXPECT_TRUE(is<Landed>(next_phase(Land{9.0}, s, kParams)));
  test::for_all(200, [](Rng& rng) {
    Situation any;
    any.time = rng.uniform(0, 100), any.rest_samples = rng.uniform_index(2000),
    any.height = rng.uniform(-1, 3);
    any.course_done = rng.uniform_index(2) == 0, any.turn_ahead = rng.uniform_index(2) == 0;
    any.since_imu = rng.uniform(0, 1), any.tilt = rng.uniform(0, 3);
    EXPECT_TRUE(is<Landed>(next_phase(Landed{}, any, kParams)));
  });
}

TEST(Phase, EveryPhaseHasItsNameAndEveryReasonItsText) {
  EXPECT_STREQ(name_of(OnGround{}), "ground");
  EXPECT_STREQ(name_of(TakeOff{}), "take-off");
  EXPECT_STREQ(name_of(Straight{}), "straight");
  EXPECT_STREQ(name_of(Turn{}), "turn");
  EXPECT_STREQ(name_of(Search{}), "search");
  EXPECT_STREQ(name_of(Land{}), "land");
  EXPECT_STREQ(name_of(Landed{}), "landed");
  EXPECT_STREQ(text_of(AbortReason::kNone), "");
  for (const AbortReason reason :
       {AbortReason::kGateNotFound, AbortReason::kNoClimb, AbortReason::kUpset,
        AbortReason::kSensorsLost, AbortReason::kNoPictures})
    EXPECT_FALSE(std::string{text_of(reason)}.empty());
}

TEST(Phase, WithoutAnImuMotorsAreCutOrTheAutopilotLands) {
  PhaseParams levelled = kParams;
  levelled.cuts_without_imu = false;
  Situation silent = flying(), stuck = flying();
  silent.since_imu = kParams.imu_timeout + 0.01;
  stuck.imu_stuck = true;
  for (const Situation& s : {silent, stuck}) {
    const Transition cut = next_phase(Straight{}, s, kParams),
                     land = next_phase(Straight{}, s, levelled);
    EXPECT_TRUE(is<Landed>(cut) && is<Land>(land));
    EXPECT_EQ(cut.reason, AbortReason::kSensorsLost);
    EXPECT_EQ(land.reason, AbortReason::kSensorsLost);
    EXPECT_TRUE(is<Landed>(next_phase(Land{9.0}, s, kParams))) << "while it lands, too";
    EXPECT_TRUE(is<Land>(next_phase(Land{9.0}, s, levelled)));
    EXPECT_FALSE(is<Landed>(next_phase(OnGround{}, s, kParams))) << "on the ground it waits";
  }
}

TEST(Phase, ACameraThatSendsNothingLeadsDownInAHurry) {
  Situation s = flying();
  s.picture_interval = 1.0 / 15.0;
  s.since_picture = kParams.picture_timeout - 0.01;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams)));
  s.since_picture = kParams.picture_timeout + 0.01;
  for (const Phase& phase : std::vector<Phase>{TakeOff{9.0}, Straight{}, Search{9.0}}) {
    const Transition t = next_phase(phase, s, kParams);
    ASSERT_TRUE(is<Land>(t));
    EXPECT_TRUE(std::get<Land>(t.phase).in_a_hurry);
    EXPECT_EQ(t.reason, AbortReason::kNoPictures);
  }
  EXPECT_EQ(next_phase(OnGround{}, s, kParams).reason, AbortReason::kNone);
  EXPECT_EQ(next_phase(Land{9.0}, s, kParams).reason, AbortReason::kNone) << "it lands already";
}

TEST(Phase, ACameraWhosePicturesAreRareIsGivenLonger) {
  Situation s = flying();
  s.picture_interval = 1.0, s.since_picture = 7.9;
  EXPECT_TRUE(is<Straight>(next_phase(Straight{}, s, kParams)));
  s.since_picture = 8.1;
  EXPECT_EQ(next_phase(Straight{}, s, kParams).reason, AbortReason::kNoPictures);
}

TEST(Phase, AFinishedCourseWithoutPicturesIsFinished) {
  Situation s = flying();
  s.course_done = true, s.since_picture = 5.0;
  EXPECT_EQ(next_phase(Straight{}, s, kParams).reason, AbortReason::kNone);
}

}  // namespace
}  // namespace gatefly
