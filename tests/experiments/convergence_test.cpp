// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/filter_race.hpp"

namespace gatefly::experiments {
namespace {

const FilterRace& race() {
  static const FilterRace flown{2201};
  return flown;
}

TEST(FilterRace, FixesComeAtTheirRateAndOnlyWhileAGateIsAhead) {
  const auto& moments = race().laps().moments;
  for (const double period : {1.0 / 15.0, 0.5}) {
    const auto fixes = race().fixes({.fix_period = period});
    ASSERT_GT(fixes.size(), 5u);
    for (std::size_t i = 0; i < fixes.size(); ++i) {
      EXPECT_TRUE(moments[fixes[i].moment].faces_gate);
      if (i == 0) continue;
      const double since = moments[fixes[i].moment].t - moments[fixes[i - 1].moment].t;
      EXPECT_GE(since, period - 1e-9);
      EXPECT_EQ(fixes[i - 1].last, since > std::max(0.3, 1.5 * period)) << since;
    }
  }
}

/// End of the flight as a filter believes it.
template <class Filter>
Eigen::Vector3d end_of(Filter filter, const FilterConditions& conditions) {
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  race().feed(filter, conditions,
              [&](const LapMoment&, const FilterTick&, const Filter& now, const FixTime*) {
                end = now.position();
                return true;
              });
  return end;
}

TEST(FilterRace, ConditionsReachTheFilterThatTheyAreMeantFor) {
  const Eigen::Vector3d drag = end_of(race().drag(), {}), imu15 = end_of(race().imu15({}), {});
  EXPECT_EQ(drag, end_of(race().drag(), {})) << "same numbers, same answer";
  const FilterConditions wrong{.told_drag = 1.2};
  EXPECT_NE(drag, end_of(race().drag(wrong), wrong));
  EXPECT_EQ(imu15, end_of(race().imu15({}, wrong), wrong)) << "it is told no drag";
  const FilterConditions noisy{.fix_sigma = 0.3}, lost{.start_sigma = 1.0};
  EXPECT_NE(imu15, end_of(race().imu15({}, noisy), noisy));
  EXPECT_NE(race().drag(lost).position(), race().drag().position());
  EXPECT_EQ(race().drag(lost).position(), race().imu15({}, lost).position());
}

// Six quick flights; the sixty of the full run are in docs/paper/results.md.
TEST(Convergence, DragFindsTheBiasSoonerUnlessItIsToldTheWrongDrag) {
  const Result result = convergence({.data = "", .quick = true});
  EXPECT_EQ(result.json.at("lasting_20_s"), result.json.at("runs"));
  std::map<std::string, nlohmann::ordered_json> by;
  for (const auto& condition : result.json.at("conditions"))
    by[condition.at("condition")] = condition;
  const auto ratio = [&](const std::string& condition, std::size_t moment) {
    return by.at(condition).at("errors").at("bias_mps2").at(moment).at("ratio").get<double>();
  };
  constexpr std::size_t kOneSecond = 1, kTwentySeconds = 5;
  EXPECT_GT(ratio("as_flown", kOneSecond), 1.5);
  for (const char* condition : {"rate_5", "rate_2", "sigma_0.3"})  // sooner; of six flights
    EXPECT_GT(ratio(condition, kOneSecond), 1.2) << condition;
  for (const char* condition : {"drag_-20", "drag_20"}) {
    EXPECT_LT(ratio(condition, kTwentySeconds), 0.6) << condition;
    EXPECT_LT(by.at(condition).at("crossover_s").at("t").get<double>(), 6.0) << condition;
  }
  const auto& as_flown = by.at("as_flown").at("crossover_s").at("t");
  EXPECT_TRUE(as_flown.is_null() || as_flown.get<double>() > 3.0);
  for (const auto& below : by.at("as_flown").at("bias_below"))
    if (below.at("threshold_mps2").get<double>() == 0.10) {
      EXPECT_LT(below.at("drag_s").get<double>(), below.at("imu15_s").get<double>());
    }
}

}  // namespace
}  // namespace gatefly::experiments
