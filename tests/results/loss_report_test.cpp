// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/loss_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/simulated_race/results/summary.hpp"

namespace gatefly::simulated_race {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

/// 20 cm right and 6 cm low of gate 3 of the course, on its second lap.
RaceResult lost_at_a_gate() {
  RaceResult result;
  result.gates_total = 15, result.gates_passed = 7, result.stop_reason = "crash";
  result.crash_time = 21.5, result.crash_object = "gate 3 right bar";
  WhyLost why{.time = 21.5, .gate = 8, .object = "right bar of gate 3"};
  why.at_its_gate = why.from_gate = true;
  why.miss = {-0.2, 0.20, 0.06};
  why.estimate = {0, 0.17, 0.05}, why.guidance = {0, 0.03, 0.0}, why.map = {0, 0.01, 0.01};
  why.detection = {0, -0.01, 0};
  why.shares = {0.175, 0.03, 0.013, -0.009};
  why.since_fix = 1.8;
  why.wind = {0.05, 0.3}, why.wind_mean = 0.32;
  result.why_lost = why;
  return result;
}

TEST(LossLine, SaysWhereByHowMuchAndWhyInOneSentence) {
  EXPECT_EQ(loss_line(lost_at_a_gate()),
            "Lost at gate 8 of 15: touched its right bar, 21 cm off its centre (20 cm right, 6 cm "
            "low): 18 cm the estimate (no fix for 1.8 s, wind 0.3 m/s from the left), 3 cm "
            "guidance, 1 cm the map; against it 1 cm detection.");
}

TEST(LossLine, WithoutWindSaysNothingOfIt) {
  auto result = lost_at_a_gate();
  result.why_lost->wind.setZero(), result.why_lost->wind_mean = 0.0;
  EXPECT_THAT(loss_line(result), Not(HasSubstr("wind")));
  EXPECT_TRUE(loss_json(result).at("wind_mps").is_null());
}

TEST(LossLine, SaysWhyThereWasNoFix) {
  auto result = lost_at_a_gate();
  result.why_lost->looks = {.pictures = 27, .gate_in_view = 0, .gate_found = 0};
  EXPECT_THAT(loss_line(result), HasSubstr("no fix for 1.8 s, the gate not whole in view"));
  result.why_lost->looks = {.pictures = 27, .gate_in_view = 12, .gate_found = 1};
  EXPECT_THAT(loss_line(result), HasSubstr("found in 1 of the 12 pictures that showed it whole"));
  result.why_lost->since_fix.reset();
  EXPECT_THAT(loss_line(result), HasSubstr("no fix at all"));
}

TEST(LossLine, AFalseAlarmIsNamedWhereDetectionIsTheCause) {
  auto result = lost_at_a_gate();
  WhyLost& why = *result.why_lost;
  std::swap(why.shares[0], why.shares[3]);
  why.cause = WhyLost::Cause::kDetection;
  why.wrong_fix = {20.4, "false gate 1"};
  EXPECT_THAT(loss_line(result),
              HasSubstr("detection (it took false gate 1 for its gate 1.1 s before)"));
}

TEST(LossLine, WallsPeopleTimeAndSearchesHaveTheirOwnWords) {
  auto result = lost_at_a_gate();
  WhyLost& why = *result.why_lost;
  why.at_its_gate = why.from_gate = false;
  why.object = "east wall", why.miss = {0.3, -1.2, 0.0};
  EXPECT_THAT(loss_line(result), HasSubstr("Lost before gate 8 of 15: touched the east wall, 1.2 m "
                                           "off its way (1.2 m left, 30 cm long): "));
  why.object = "person 1", why.cause = WhyLost::Cause::kInTheWay;
  EXPECT_THAT(loss_line(result),
              EndsWith("touched person 1, which stood in its way and is on no map."));
  why.how = WhyLost::How::kGivenUp, why.cause = WhyLost::Cause::kGivenUp;
  why.reason = "the IMU went silent";
  EXPECT_EQ(loss_line(result), "Lost before gate 8 of 15: gave up, the IMU went silent.");
}

TEST(LossJson, HoldsTheNumbersAndIsNullWhenFinished) {
  const auto json = summary(lost_at_a_gate(), {}).at("why_lost");
  EXPECT_EQ(json.at("line"), loss_line(lost_at_a_gate()));
  EXPECT_EQ(json.at("cause"), "estimate");
  EXPECT_EQ(json.at("object"), "right bar of gate 3");
  EXPECT_DOUBLE_EQ(json.at("miss").at("lateral_cm"), 20.0);
  EXPECT_EQ(json.at("parts")[0].at("cause"), "estimate");
  EXPECT_DOUBLE_EQ(json.at("parts")[0].at("lateral_cm"), 17.0);
  EXPECT_DOUBLE_EQ(json.at("parts")[0].at("vertical_cm"), 5.0);
  EXPECT_DOUBLE_EQ(json.at("since_fix_s"), 1.8);
  EXPECT_EQ(json.at("wind_from"), "the left");
  EXPECT_TRUE(summary(RaceResult{}, {}).at("why_lost").is_null());
}

TEST(Summary, SaysTheTruthUnderTheNamesOfWhatIsFound) {
  RaceResult result;
  result.truth.tilt = 5 * kDegree, result.truth.latency = -0.020, result.truth.moved_gate = 3;
  result.findings.emplace();
  const auto json = summary(result, {}), truth = json.at("truth");
  EXPECT_NEAR(truth.at("camera_tilt_deg").get<double>(), 5.0, 1e-9);
  EXPECT_NEAR(truth.at("latency_ms").get<double>(), -20.0, 1e-9);
  EXPECT_EQ(truth.at("moved_gate"), 3);
  for (const char* both :
       {"camera_tilt_deg", "camera_pan_deg", "camera_roll_deg", "latency_ms", "focal"}) {
    EXPECT_TRUE(truth.contains(both)) << both;
    EXPECT_TRUE(json.at("found").contains(both)) << both;
  }
}

TEST(Summary, HasNoSpeedAndNoErrorBeforeTheFirstGate) {
  RaceResult result;
  result.gates_total = 5;
  auto json = summary(result, {});
  for (const char* key : {"mean_speed_mps", "max_speed_mps", "estimation_rmse_m"})
    EXPECT_TRUE(json.at(key).is_null()) << key;
  result.gates_passed = 1;
  json = summary(result, {});
  EXPECT_TRUE(json.at("mean_speed_mps").is_null()) << "from the first gate to the second";
  EXPECT_FALSE(json.at("max_speed_mps").is_null());
}

}  // namespace
}  // namespace gatefly::simulated_race
