// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/experiments/detection_examples.hpp"
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

// Li18 §3.1: the race of 2017 took the gate of the highest colour fitness; .448 at .074.
TEST_F(RealData, TheBestGateAloneCostsFewHitsAndSparesFalsePositives) {
  const Result result = roc_fitness(quick);
  const auto& best = result.json.at("one_gate").at(0);
  EXPECT_EQ(best.at("detector"), "best_of_paper");
  EXPECT_NEAR(best.at("tpr").get<double>(), best.at("paper").at("tpr").get<double>(), 0.06);
  EXPECT_LT(best.at("fp_per_image").get<double>(),
            best.at("paper").at("fp_per_image").get<double>());
  const auto& all = result.json.at("points").at(0);  // every candidate, any fitness
  EXPECT_LT(best.at("fp_per_image").get<double>(), 0.6 * all.at("fp_per_image").get<double>());
  EXPECT_NEAR(best.at("tpr").get<double>(), all.at("tpr").get<double>(), 0.03);
}

TEST_F(RealData, TheBestGateIsTheFittestOfAllCandidates) {
  const LabelledSet set(real_data() / "tudelft_bebop_gates" / "basement32_hq");
  const Found all = run(set, as_paper({.min_color_fitness = 0.0}), 0),
              best = run(set, as_paper_best({.min_color_fitness = 0.0}), 0);
  int compared = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    ASSERT_EQ(best[i].size(), all[i].empty() ? 0u : 1u) << i;
    for (const GateDetection& gate : all[i]) {
      EXPECT_LE(gate.fitness, best[i].front().fitness) << i;
      ++compared;
    }
  }
  EXPECT_GT(compared, 15);
}

TEST_F(RealData, OurDetectorFindsMoreThanThePapersAtEveryDistance) {
  const Result result = tpr_distance(quick);
  for (const auto& bin : result.json.at("bins")) {
    const double gates = bin.at("gates"), own = bin.at("own_hits").get<double>() / gates;
    EXPECT_GE(own, bin.at("paper").at("tpr").get<double>() + 0.25) << bin;
    EXPECT_GE(2.0 * bin.at("own_hits").get<double>(), bin.at("hits").get<double>()) << bin;
  }
  EXPECT_LT(result.json.at("own").at("fp_per_image_on_no_gate").get<double>(), 0.03);
  ASSERT_EQ(result.extra.size(), 1u);
  EXPECT_EQ(result.extra.front().name, "examples");
}

TEST_F(RealData, ExamplesAreWhatTheyAreCalled) {
  const auto folder = real_data() / "tudelft_bebop_gates" / "basement580";
  const LabelledSet set(folder);
  const std::vector<Found> runs{run(set, as_paper(), 0), run(set, as_paper(), 1)};
  const auto [hit, wrong, missed] =
      detection_examples(set, runs, unlabelled_gates(set, folder / "unlabelled_gates.csv"));
  const auto hits = [&](std::size_t picture, const Found& found) {
    const files::PictureToScore one = to_score(set, found)[picture];
    return files::score({&one, 1}, files::Rule::kOverlap70Authors).hits;
  };
  ASSERT_TRUE(hit.picture && wrong.picture && missed.picture);
  EXPECT_EQ(hits(*hit.picture, runs[0]), 1);
  for (const Quad& gate : set.labels.pictures[*wrong.picture].gates)
    EXPECT_EQ(files::polygon_shared_area(gate, wrong.found->corners_px), 0.0);
  EXPECT_FALSE(set.labels.pictures[*missed.picture].gates.empty());
  for (const Found& found : runs) EXPECT_EQ(hits(*missed.picture, found), 0);
  EXPECT_FALSE(missed.found);
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
