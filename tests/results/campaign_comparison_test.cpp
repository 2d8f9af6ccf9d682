// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/campaign_comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gatefly::simulated_race {
namespace {

using ::testing::ElementsAre;

TEST(McnemarExact, IsTwoTailsOfTheBinomial) {
  EXPECT_DOUBLE_EQ(mcnemar_exact(0, 0), 1.0);
  EXPECT_DOUBLE_EQ(mcnemar_exact(3, 3), 1.0);
  EXPECT_NEAR(mcnemar_exact(10, 1), 2.0 * 12.0 / 2048.0, 1e-12);  // (C(11,0) + C(11,1)) / 2^11
  EXPECT_NEAR(mcnemar_exact(0, 6), 2.0 / 64.0, 1e-12);
  EXPECT_EQ(mcnemar_exact(10, 1), mcnemar_exact(1, 10));
  const double many = mcnemar_exact(2000, 2300);
  EXPECT_GT(many, 0.0);
  EXPECT_LT(many, 1e-5);
}

RunRow run(std::uint64_t seed, bool finished, double time = 30.0) {
  RunRow row;
  row.seed = seed, row.finished = finished, row.time = time, row.gates = finished ? 6 : 2;
  return row;
}

TEST(CampaignComparison, PairsBySeedAndTimesWhereBothFinished) {
  const auto json = campaign_comparison(
      {run(1, true, 30.0), run(2, true), run(3, false), run(4, false), run(5, true, 20.0),
       run(9, true)},
      {run(5, true, 24.0), run(4, true), run(3, false), run(2, false), run(1, true, 28.0)});
  EXPECT_EQ(json.at("pairs"), 5);
  EXPECT_EQ(json.at("unpaired"), 1);
  EXPECT_EQ(json.at("both_finished"), 2);
  EXPECT_EQ(json.at("neither_finished"), 1);
  EXPECT_EQ(json.at("only_first"), nlohmann::json({2}));
  EXPECT_EQ(json.at("only_second"), nlohmann::json({4}));
  EXPECT_DOUBLE_EQ(json.at("mcnemar_p").get<double>(), 1.0);
  EXPECT_DOUBLE_EQ(json.at("second_minus_first").at("race_time_s").at("p50").get<double>(), 1.0);
}

TEST(CampaignComparison, SaysInWhichArgumentsTheyDiffer) {
  const nlohmann::json first{{"commit", "a"},
                             {"first_seed", 1},
                             {"shard", {1, 2}},
                             {"track_toml", "x"},
                             {"config", {{"control", {{"speed_mps", 2.0}, {"mode", "ours"}}}}}};
  nlohmann::json second = first;
  EXPECT_THAT(argument_differences(first, second), ElementsAre());
  second["first_seed"] = 7, second["shard"] = {2, 2}, second["track_toml"] = "y";
  second["config"]["control"]["speed_mps"] = 1.5;
  second["config"]["control"].erase("mode");
  EXPECT_THAT(argument_differences(first, second),
              ElementsAre("control.mode: \"ours\" | null", "control.speed_mps: 2.0 | 1.5",
                          "the track file"));
}

}  // namespace
}  // namespace gatefly::simulated_race
