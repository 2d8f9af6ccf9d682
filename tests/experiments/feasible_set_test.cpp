// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/feasible_set.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/experiments/experiment.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kHalfOpening = 0.25;  // [m]

const LateralLoop& loop_of(const std::string& key) {
  static const std::vector<LateralLaw> laws = lateral_laws();
  return std::find_if(laws.begin(), laws.end(), [&](const auto& law) { return law.key == key; })
      ->loop;
}

TEST(FeasibleSet, LeftIsRightMirrored) {
  for (const LateralLaw& law : lateral_laws())
    for (const double y0 : {0.1, 0.8, 3.0}) {
      const auto right = lateral_course(law.loop, y0, 3.0),
                 left = lateral_course(law.loop, -y0, 3.0);
      for (std::size_t i = 0; i < right.size(); ++i)
        ASSERT_NEAR(right[i], -left[i], 1e-12) << law.key << " " << i;
    }
}

// ÿ = 2 (−y − ẏ): y = y0 e⁻ᵗ (cos t + sin t).
TEST(FeasibleSet, OfTheLinearLawWithoutDragIsTheClosedForm) {
  LateralLoop linear = loop_of("printed");
  linear.k_y = 0.0;
  const FeasibleSet set(linear, 3.0, 3.0);
  for (double t = 0.0; t < 1.9; t += 0.05) {
    const double shrunk = std::exp(-t) * (std::cos(t) + std::sin(t));
    EXPECT_NEAR(set.offset(t, 0.7), 0.7 * shrunk, 1e-6) << t;
    EXPECT_NEAR(set.boundary(t, kHalfOpening), std::min(3.0, kHalfOpening / shrunk), 1e-5) << t;
  }
}

TEST(FeasibleSet, MoreTimeNeverTakesAStartAwayFromLawsThatDoNotOvershoot) {
  for (const char* key : {"printed", "ours"}) {
    const FeasibleSet set(loop_of(key), 3.0, 10.0 / 3.0);
    double before = 0.0;
    for (double t = 0.0; t < 10.0 / 3.0; t += 0.02) {
      const double now = set.boundary(t, kHalfOpening);
      EXPECT_GE(now, before - 1e-9) << key << " " << t;
      before = now;
    }
    EXPECT_EQ(before, 3.0) << key;
  }
}

// The flown gains have ζ 0.6: what starts 2 m beside and 2.4 m ahead at 1.5 m/s meets the other bar.
TEST(FeasibleSet, TheFlownLawOvershootsAndMoreTimeCanHarm) {
  const FeasibleSet flown(loop_of("flown"), 3.0, 10.0 / 3.0);
  const double time = 2.4 / 1.5, start = 2.0;
  EXPECT_LT(flown.offset(time, start), -kHalfOpening);
  EXPECT_LT(std::abs(flown.offset(2.0 / 1.5, start)), kHalfOpening);
  const auto edges = flown.edges(time, kHalfOpening);
  ASSERT_FALSE(edges.empty());
  EXPECT_TRUE(edges.front().overshot);
  EXPECT_DOUBLE_EQ(flown.boundary(time, kHalfOpening), edges.front().y0);
  for (const auto& edge : FeasibleSet(loop_of("ours"), 3.0, 10.0 / 3.0).edges(time, kHalfOpening))
    EXPECT_FALSE(edge.overshot);
}

TEST(FeasibleSet, AFastRollIsARollWithoutLagAndASlowOnePassesLess) {
  LateralLoop lagging = loop_of("flown_no_lag");
  lagging.lag = {.omega = 400.0, .zeta = 1.0};
  const auto fast = lateral_course(lagging, 0.8, 2.0),
             ideal = lateral_course(loop_of("flown_no_lag"), 0.8, 2.0);
  for (std::size_t i = 0; i < fast.size(); ++i) ASSERT_NEAR(fast[i], ideal[i], 0.02) << i;
  const FeasibleSet with(loop_of("flown"), 3.0, 2.0), without(loop_of("flown_no_lag"), 3.0, 2.0);
  for (const double y0 : {0.3, 0.5, 0.8})
    EXPECT_GT(with.time_needed(y0, kHalfOpening), without.time_needed(y0, kHalfOpening)) << y0;
}

TEST(FeasibleSet, TimeNeededIsNotANumberForWhatNeverPasses) {
  const LateralLoop nobody_steers{.roll_command = [](double, double) { return 0.0; }};
  const FeasibleSet set(nobody_steers, 3.0, 2.0);
  EXPECT_TRUE(std::isnan(set.time_needed(0.3, kHalfOpening)));
  EXPECT_EQ(set.time_needed(0.2, kHalfOpening), 0.0);
  EXPECT_NEAR(set.boundary(1.0, kHalfOpening), kHalfOpening, 1e-9);
}

// Li18 §4: 0.8 m beside the axis at 1.5 m/s needs 2 m.
TEST(FeasibleSetStudy, ConfirmsThePapersTwoMetresForItsPrintedLawAndFasterNeedsMore) {
  const Result result = feasible_set({});
  EXPECT_NEAR(result.json.at("half_opening_m").get<double>(), kHalfOpening, 1e-12);
  EXPECT_NEAR(result.json.at("printed_without_drag_m").get<double>(), 2.0, 0.05);
  const auto by_speed = [&](const char* list, const char* what, const char* law, double opening,
                            double error) {
    std::vector<double> values;
    for (const auto& row : result.json.at(list))
      if (row.at("half_opening_m").get<double>() == opening && row.value("error_m", error) == error)
        values.push_back(row.at(what).at(law).get<double>());
    return values;
  };
  for (const char* law : {"printed", "flown", "flown_no_lag", "ours"})
    for (const double opening : {result.json.at("half_opening_m").get<double>(), 0.5}) {
      const auto share = by_speed("passing", "share", law, opening, 0.0);
      const auto distance = by_speed("distance_needed", "distance_m", law, opening, 0.8);
      ASSERT_EQ(share.size(), 2u);
      ASSERT_EQ(distance.size(), 2u);
      EXPECT_LT(share[1], share[0]) << law << ": 2.0 m/s against 1.5 m/s";
      EXPECT_NEAR(distance[1] / distance[0], 2.0 / 1.5, 1e-9) << law;
    }
}

}  // namespace
}  // namespace gatefly::experiments
