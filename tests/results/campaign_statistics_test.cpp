// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/campaign_statistics.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/simulated_race/results/summary.hpp"

namespace gatefly::simulated_race {
namespace {

TEST(Wilson95, GivesTheTextbooksIntervals) {
  // Newcombe 1998, table I: 81 of 263; 15 of 148; 0 of 20; 1 of 29.
  struct Case {
    int hits, trials;
    double low, high;
  };
  for (const Case& c : {Case{81, 263, 0.2553, 0.3662},
                        {15, 148, 0.0624, 0.1605},
                        {0, 20, 0.0000, 0.1611},
                        {1, 29, 0.0061, 0.1718}}) {
    const Interval interval = wilson95(c.hits, c.trials);
    EXPECT_NEAR(interval.low, c.low, 5e-5) << c.hits << '/' << c.trials;
    EXPECT_NEAR(interval.high, c.high, 5e-5) << c.hits << '/' << c.trials;
  }
}

TEST(Wilson95, IsSymmetricStaysWithinZeroAndOneAndHoldsTheRate) {
  for (int n = 1; n < 60; ++n)
    for (int hits = 0; hits <= n; ++hits) {
      const Interval a = wilson95(hits, n), b = wilson95(n - hits, n);
      EXPECT_NEAR(a.low, 1.0 - b.high, 1e-12);
      EXPECT_GE(a.low, 0.0);
      EXPECT_LE(a.high, 1.0);
      const double rate = static_cast<double>(hits) / n;
      EXPECT_LE(a.low, rate + 1e-12);
      EXPECT_GE(a.high, rate - 1e-12);
    }
}

TEST(Wilson95, NoTrialsSayNothing) {
  EXPECT_EQ(wilson95(0, 0).low, 0.0);
  EXPECT_EQ(wilson95(0, 0).high, 1.0);
}

RunRow ended(std::uint64_t seed, const std::string& cause, double time = 30.0) {
  RunRow row;
  row.seed = seed, row.finished = cause == "finished", row.cause = cause;
  row.gates = row.finished ? 6 : 2, row.gates_total = 6, row.time = time, row.mean_speed = 1.5;
  row.rmse = {0.1, 0.2, 0.3};
  return row;
}

TEST(CampaignResult, RanksCausesByHowOftenAndNamesTheirSeeds) {
  const auto json = campaign_result({ended(1, "finished", 20.0), ended(2, "timeout"),
                                     ended(3, "crash: gate 2 pole"), ended(4, "crash: gate 2 pole"),
                                     ended(5, "finished", 30.0)});
  EXPECT_EQ(json.at("runs"), 5);
  EXPECT_EQ(json.at("finished"), 2);
  EXPECT_DOUBLE_EQ(json.at("completion_rate").get<double>(), 0.4);
  EXPECT_EQ(json.at("gates_passed"), 18);
  EXPECT_EQ(json.at("gates_total"), 30);
  EXPECT_DOUBLE_EQ(json.at("race_time_s").at("p50").get<double>(), 25.0);  // of the finished ones
  ASSERT_EQ(json.at("causes").size(), 2u);
  EXPECT_EQ(json.at("causes")[0].at("cause"), "crash: gate 2 pole");
  EXPECT_EQ(json.at("causes")[0].at("seeds"), nlohmann::json::array({3, 4}));
  EXPECT_EQ(json.at("causes")[1].at("cause"), "timeout");
}

TEST(CampaignResult, WithoutAnyFinishHasNoTimes) {
  const auto json = campaign_result({ended(1, "timeout")});
  EXPECT_TRUE(json.at("race_time_s").is_null());
  EXPECT_EQ(json.at("completion_rate"), 0.0);
  EXPECT_TRUE(campaign_result({}).at("race_time_s").is_null());
}

TEST(RunRow, ReadsWhatSummaryWrites) {
  RaceResult result;
  result.gates_total = 6, result.gates_passed = 3, result.stop_reason = "crash";
  result.crash_time = 12.5, result.crash_object = "gate 2 left bar";
  result.race_time = 11.25, result.mean_speed = 1.6, result.max_speed = 1.9;
  result.estimation_rmse = {0.1, 0.2, 0.3};
  result.consistency = {{.samples = 4, .sum_per_dof = 5.0, .inside = 3},
                        {.samples = 2, .sum_per_dof = 1.0, .inside = 2},
                        2};
  result.through_false_gates = 2, result.through_other_gates = 1;
  result.frames = 100, result.true_positives = 40, result.false_positives = 3, result.searches = 1;
  WhyLost why{.cause = WhyLost::Cause::kMap};
  why.shares = {0.04, -0.01, 0.205, 0.0}, why.since_fix = 1.5;
  result.why_lost = why;
  const RunRow row = row_of(summary(result, {"oval", 17, "ideal", "1.2.3", "c0", "f0", {}}));
  EXPECT_EQ(row.seed, 17u);
  EXPECT_FALSE(row.finished);
  EXPECT_EQ(row.cause, "crash: gate 2 left bar");
  EXPECT_EQ(
      runs_csv({row}),
      "seed,finished,gates,gates_total,time_s,mean_speed_mps,max_speed_mps,cause,"
      "rmse_x_m,rmse_y_m,rmse_z_m,frames,true_positives,false_positives,searches,"
      "nees_mean,nees_inside,nis_mean,nis_inside,divergences,why,estimate_cm,guidance_cm,"
      "map_cm,detection_cm,since_fix_s,commit,configuration,tilt_error_deg,tilt_sigma_deg,"
      "heading_error_deg,heading_sigma_deg,thrust_error_percent,thrust_sigma_percent,"
      "latency_error_ms,latency_sigma_ms,map_reports,through_false_gates,through_other_gates\n"
      "17,0,3,6,11.25,1.6,1.9,crash: gate 2 left "
      "bar,0.1,0.2,0.3,100,40,3,1,1.25,0.75,0.5,1,2,map,4,-1,20.5,0,1.5,c0,f0,,,,,,,,,0,2,1\n");
  EXPECT_EQ(campaign_result({row, row}).at("stray_passes"),
            nlohmann::json::parse(R"({"false_gates": 4, "gates_out_of_turn": 2})"));
  EXPECT_EQ(campaign_result({row}).at("lost_by"),
            nlohmann::json::parse(R"([{"cause": "map", "count": 1, "seeds": [17]}])"));

  result.gates_passed = 0;
  EXPECT_THAT(runs_csv({row_of(summary(result, {}))}),
              ::testing::HasSubstr("\n1,0,0,6,11.25,,,crash: gate 2 left bar,,,,100"))
      << "no speed and no error before the first gate";
  result.crash_time.reset();
  result.stop_reason = "abort", result.abort_reason = "lost, twice";
  EXPECT_EQ(row_of(summary(result, {})).cause, "abort: lost, twice");
  EXPECT_NE(runs_csv({row_of(summary(result, {}))}).find(",\"abort: lost, twice\","),
            std::string::npos);
  result.stop_reason = "timeout", result.abort_reason = "";
  EXPECT_EQ(row_of(summary(result, {})).cause, "timeout");
}

}  // namespace
}  // namespace gatefly::simulated_race
