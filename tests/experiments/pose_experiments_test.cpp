// SPDX-License-Identifier: Apache-2.0
// Slices of the pose studies; the whole ones are `gatefly reproduce pose-...`.
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/pnp.hpp"
#include "gatefly/experiments/pose_trial.hpp"

#include "support/real_data.hpp"

namespace gatefly::experiments {
namespace {

namespace fs = std::filesystem;

TEST(Pnp, EveryWayFindsTheCameraFromExactCorners) {
  if (!has_pnp()) GTEST_SKIP() << kNoPnp;
  const CameraRig rig = study_rig();
  const Eigen::Vector3d p_GB{-2.0, 0.4, 0.1};
  const Attitude attitude{0.1, -0.1, -0.3};  // a gate seen askew has one solution only
  const Quad px = corners_seen_from(p_GB, attitude, rig);
  for (const Pnp method : {Pnp::kP3p, Pnp::kIppe, Pnp::kIppeSquare, Pnp::kSqpnp, Pnp::kIterative}) {
    const auto found = by_pnp(method, px, rig, 1.0);
    ASSERT_TRUE(found) << static_cast<int>(method);
    EXPECT_LT((*found - p_GB).norm(), 1e-3) << static_cast<int>(method);
  }
  const auto kneip = by_kneip({}, px, rig, 1.0);
  ASSERT_TRUE(kneip);
  EXPECT_LT((*kneip - p_GB).norm(), 1e-6);
  EXPECT_LT((*by_rays(px, attitude, rig, 1.0) - p_GB).norm(), 1e-9);
}

TEST(Pnp, FourthCornerTellsTheAnswersOfAnyTripleApart) {
  const CameraRig rig = study_rig();
  const Eigen::Vector3d p_GB{-1.5, -0.3, 0.2};
  const Attitude attitude{-0.2, 0.1, 0.4};
  const Quad px = corners_seen_from(p_GB, attitude, rig);
  for (const int triples : {1, 4})
    for (const bool squares : {false, true}) {
      const auto found =
          by_kneip({.complex_roots = false, .squares = squares, .triples = triples}, px, rig, 1.0);
      ASSERT_TRUE(found);
      EXPECT_LT((*found - p_GB).norm(), 1e-6);
    }
}

// Three corners a little off leave no real root where two answers meet: the authors took the real
// part, and had one.
TEST(Pnp, RealPartsOfComplexRootsAreAnswersToo) {
  const CameraRig rig = study_rig();
  const Eigen::Vector3d p_GB{-3.5, 0, 0};
  const Quad exact = corners_seen_from(p_GB, {}, rig);
  sim::Stream random(1, "complex-roots");
  Rmse with, without;
  for (int i = 0; i < 500; ++i) {
    Quad px = exact;
    for (Eigen::Vector2d& corner : px) corner += Eigen::Vector2d{random.normal(), random.normal()};
    with.add(by_kneip({}, px, rig, 1.0), p_GB),
        without.add(by_kneip({.complex_roots = false}, px, rig, 1.0), p_GB);
  }
  EXPECT_EQ(with.none, 0);
  EXPECT_LT(with.axis(0), without.axis(0));
}

// 500 trials: an RMSE's standard error is 3 %, so that a few points may fall out of 10 %.
TEST(PoseStudies, LeastSquaresAndP3pGiveTheAuthorsCurvesAndTheRecomputedTable) {
  const Result result = pose_ls_p3p({.data = {}, .quick = true});
  int curves = 0;
  for (const auto& curve : result.json.at("curves")) {
    const std::string name = curve.at("curve");
    if (name.rfind("LS", 0) != 0) continue;
    ++curves;
    EXPECT_GE(curve.at("within").get<int>(), curve.at("compared").get<int>() - 1)
        << curve.at("study") << " " << name;
  }
  EXPECT_EQ(curves, 9);
  // P3P's errors have long tails: an RMSE of 500 trials may be 10 % off.
  const auto& variants = result.json.at("p3p_variants");
  const int authors = variants.front().at("within");
  EXPECT_GE(authors, 22);
  for (const auto& variant : variants)
    EXPECT_GE(authors, variant.at("within").get<int>() - 2) << variant.at("variant");
}

TEST(PoseStudies, SideBarsGiveTheAuthorsCurves) {
  const Result result = pose_bars({.data = {}, .quick = true});
  EXPECT_EQ(result.json.at("lines").size(), 8u);
  for (const auto& line : result.json.at("lines"))
    EXPECT_GE(line.at("within").get<int>(), 4) << line.at("line");
}

// 50 trials a cell: single cells scatter by 10 %, most must keep what all keep with 1,000.
TEST(PoseStudies, OurPoseIsRarelySecondBest) {
  const Result result = pose_grid({.data = {}, .quick = true});
  EXPECT_LT(result.json.at("most_refused").get<double>(), 0.1);
  for (const auto& claim : result.json.at("claims"))
    EXPECT_GE(claim.at("kept").get<double>(), 0.85 * claim.at("cells").get<double>()) << claim;
}

class RealPoses : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::is_directory(support::real_data() / "tudelft_bebop_flights"))
      GTEST_SKIP() << "no real data at " << support::real_data() << " (set GATEFLY_DATA)";
  }
};

TEST_F(RealPoses, DistancesAreRightWithinSixPercentAndFlightElevenWithinItsLimits) {
  const Result result = pose_real({.data = support::real_data().string()});
  const auto& distances = result.json.at("distance51").at("distances");
  ASSERT_EQ(distances.size(), 5u);
  double ours = 0.0, theirs = 0.0;  // scatter, over all distances
  for (const auto& at : distances) {
    const double truth = at.at("true_m");
    EXPECT_NEAR(at.at("mean_m").get<double>(), truth, 0.06 * truth);
    ours += std::pow(at.at("std_m").get<double>(), 2);
    if (has_pnp()) theirs += std::pow(at.at("pnp_std_m").get<double>(), 2);
  }
  if (has_pnp()) {
    EXPECT_LT(ours, theirs);
  }
  // Nothing grows with the distance beyond what the drone was held elsewhere, which labels and
  // detections both see.
  const auto& slopes = result.json.at("distance51").at("slopes");
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_LT(std::abs(slopes.at(i).at("slope").get<double>()),
              2.0 * slopes.at(i).at("slope_sigma").get<double>())
        << slopes.at(i);
    // 95 % of 3 degrees of freedom
    EXPECT_LT(slopes.at(i).at("chi2").get<double>(), 7.8) << slopes.at(i);
  }
  for (const auto& at : distances)
    EXPECT_GT(at.at("moved_std_m").get<double>(), 0.4 * at.at("std_m").get<double>()) << at;
  const auto& flight = result.json.at("flight_11");
  EXPECT_NEAR(flight.at("best_side_m").get<double>(), 1.0, 0.02);
  for (const char* axis : {"rmse_x_m", "rmse_y_m"}) {
    EXPECT_LE(flight.at("labels").at(axis).get<double>(), 0.12);
    EXPECT_LE(flight.at("detections").at(axis).get<double>(), 0.20);
  }
  EXPECT_GE(flight.at("detections").at("frames").get<int>(), 17);
  EXPECT_LT(flight.at("fitted").at("rms_px").get<double>(), 2.0);
}

}  // namespace
}  // namespace gatefly::experiments
