// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"

#include "support/real_data.hpp"

namespace gatefly::experiments {
namespace {

namespace fs = std::filesystem;
using support::real_data;
using ::testing::HasSubstr;

TEST(InParallel, DoesEveryPieceOnce) {
  std::vector<int> done(1000);
  in_parallel(done.size(), [&](std::size_t i) { ++done[i]; });
  EXPECT_EQ(done, std::vector<int>(1000, 1));
  in_parallel(0, [](std::size_t) { FAIL(); });
}

TEST(DistanceFromArea, PassesThroughTheAuthorsPointsAndFalls) {
  EXPECT_DOUBLE_EQ(distance_from_area(1000), 5.2);
  EXPECT_DOUBLE_EQ(distance_from_area(3250), 2.975);
  EXPECT_DOUBLE_EQ(distance_from_area(6000), 1.9);
  for (double area = 10; area < 50'000; area *= 1.1) {
    EXPECT_GT(distance_from_area(area), distance_from_area(1.1 * area)) << area;
    EXPECT_GT(distance_from_area(area), 0.0);
  }
}

TEST(Experiments, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const Experiment& experiment : all())
    EXPECT_TRUE(names.insert(experiment.name).second) << experiment.name;
}

TEST(Experiments, WithoutDataSayHowToNameIt) {
  for (const Experiment& experiment : all()) try {
      if (!experiment.needs_data) continue;
      (void)experiment.run({.data = fs::temp_directory_path().string()});
      FAIL() << experiment.name;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr("there is no such folder"));
    }
}

class RealData : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::is_directory(real_data() / "tudelft_bebop_gates"))
      GTEST_SKIP() << "no real pictures at " << real_data() << " (set GATEFLY_DATA)";
  }
  Options quick{.data = real_data().string(), .quick = true};
};

// The authors' two stored runs at σ_L 25: .493 at .182 with σ_cf 0, .460 at .064 with 0.7.
TEST_F(RealData, TheRocPassesThroughTheAuthorsPoints) {
  int compared = 0;
  const Result result = roc_fitness(quick);
  for (const auto& point : result.json.at("points")) {
    const double tpr = point.at("tpr"), paper = point.at("paper").at("tpr");
    EXPECT_NEAR(tpr, paper, 0.05) << point;
    const double fitness = point.at("sigma_cf");
    if (fitness != 0.0 && fitness != 0.7) continue;
    const double ratio =
        point.at("fp_per_image").get<double>() / point.at("paper").at("fp_per_image").get<double>();
    EXPECT_NEAR(tpr, paper, 0.03) << point;
    EXPECT_GT(ratio, 1 / 1.5) << point;
    EXPECT_LT(ratio, 1.5) << point;
    ++compared;
  }
  EXPECT_EQ(compared, 2);
}

TEST_F(RealData, TwoRunsAreTheSameAndStoppingIsHeard) {
  const Result a = tpr_distance(quick), b = tpr_distance(quick);
  EXPECT_EQ(a.csv, b.csv);
  EXPECT_EQ(a.json, b.json);
  Options stopped = quick;
  stopped.stopped = [] { return true; };
  for (const Experiment& experiment : all())
    EXPECT_THROW((void)experiment.run(stopped), Stopped) << experiment.name;
}

}  // namespace
}  // namespace gatefly::experiments
