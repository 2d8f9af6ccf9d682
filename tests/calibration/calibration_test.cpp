// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>

#include <gtest/gtest.h>

#include "gatefly/tasks/calibration/corner_list.hpp"

#include "calibration/synthetic_board.hpp"
#include "support/for_all.hpp"
#include "support/real_data.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::calibration {
namespace {

using namespace test;
using gatefly::test::error_of;
using gatefly::test::for_all;

class EveryModel : public ::testing::TestWithParam<LensModel> {};
INSTANTIATE_TEST_SUITE_P(All, EveryModel, ::testing::ValuesIn(kLensModels), [](const auto& test) {
  std::string name = name_of(test.param);
  std::erase(name, '-');
  return name;
});

const ModelResult& result_of(const Calibration& answer, LensModel model) {
  return *std::find_if(answer.models.begin(), answer.models.end(),
                       [&](const auto& each) { return each.fit.model == model; });
}

/// Calibrations of the typical lens of a model from 20 pictures each, made once.
const std::vector<Calibration>& calibrations(LensModel model) {
  static std::map<LensModel, std::vector<Calibration>> made;
  auto& answers = made[model];
  for (std::uint64_t seed = 1 + answers.size(); seed <= 5; ++seed) {
    Rng rng{seed};
    answers.push_back(calibrate(synthetic_views(typical_lens(model), kSize, {}, rng), kSize));
  }
  return answers;
}

TEST_P(EveryModel, ItsParametersComeBackWithinTheirStandardDeviations) {
  const Eigen::VectorXd expected = parameters_of(typical_lens(GetParam())).parameters;
  double squared = 0.0, count = 0.0;
  for (const Calibration& answer : calibrations(GetParam())) {
    const LensFit& fit = result_of(answer, GetParam()).fit;
    ASSERT_EQ(fit.sigma.size(), expected.size());
    const Eigen::ArrayXd sigmas = (fit.parameters - expected).array() / fit.sigma.array();
    EXPECT_LT(sigmas.abs().maxCoeff(), 4.0);
    squared += sigmas.square().sum();
    count += static_cast<double>(sigmas.size());
    // A corner scatters by 0.1 px in each of two axes; poses and lens take a little of it.
    EXPECT_NEAR(result_of(answer, GetParam()).rms_px, 0.1 * std::sqrt(2.0), 0.015);
  }
  EXPECT_GT(squared / count, 0.3);  // on average one standard deviation off, neither more nor less;
  EXPECT_LT(squared / count, 2.0);  // parameters of one fit depend on each other
}

TEST_P(EveryModel, HeldOutPicturesRecommendIt) {
  const auto& answers = calibrations(GetParam());
  const auto right = std::count_if(answers.begin(), answers.end(), [&](const Calibration& answer) {
    return answer.models[answer.recommended].fit.model == GetParam();
  });
  EXPECT_GE(right, 4);  // one standard error: chance decides now and then
}

TEST_P(EveryModel, ExactCornersGiveTheExactLens) {
  Rng rng{1};
  Holding exact;
  exact.noise_px = 0.0;
  const AnyCamera truth = typical_lens(GetParam());
  const Calibration answer = calibrate(synthetic_views(truth, kSize, exact, rng), kSize);
  // The fit's own formulas and the flight code's are the same ones.
  const Eigen::VectorXd found = result_of(answer, GetParam()).fit.parameters,
                        expected = parameters_of(truth).parameters;
  EXPECT_LT(
      (found - expected).cwiseQuotient(expected.cwiseAbs().cwiseMax(1.0)).cwiseAbs().maxCoeff(),
      1e-5);
  EXPECT_LT(result_of(answer, GetParam()).rms_px, 1e-5);
}

TEST(Calibrate, BadCornersAndBadPicturesAreLeftOutAndSaid) {
  for_all(3, [](Rng& rng) {
    const AnyCamera truth = typical_lens(LensModel::kKannalaBrandt);
    BoardViews views = synthetic_views(truth, kSize, {.views = 24}, rng);
    for (std::size_t v = 3; v < views.size(); ++v)  // 2 corners of most pictures lie 5-40 px off
      for (int k = 0; k < 2; ++k) {
        const auto corner = static_cast<std::size_t>(rng.uniform(0, 47.99));
        views[v].corners[corner].px += Eigen::Vector2d{rng.uniform(5, 40), rng.uniform(-40, -5)};
      }
    for (std::size_t v = 0; v < 2; ++v)  // two pictures are blurred
      for (BoardCorner& corner : views[v].corners)
        corner.px += 3.0 * Eigen::Vector2d{normal(rng), normal(rng)};
    for (std::size_t i = 0; i < 48; ++i)  // and one has its corners in columns instead of rows
      views[2].corners[i].p_W = {0.03 * static_cast<double>(i / 6),
                                 0.03 * static_cast<double>(i % 6)};

    const Calibration answer = calibrate(views, kSize);
    EXPECT_EQ(name_of(answer.best().fit.model), "kannala-brandt");
    EXPECT_LT(answer.best().rms_px, 0.17);
    EXPECT_EQ(answer.kept.size(), 21U);
    for (std::size_t v = 0; v < 3; ++v) EXPECT_NE(answer.views[v].reason, "") << v;
    for (std::size_t v = 3; v < views.size(); ++v) {
      EXPECT_EQ(answer.views[v].reason, "") << v;
      EXPECT_GE(answer.views[v].dropped, 1U) << v;
      EXPECT_LE(answer.views[v].dropped, 3U) << v;
    }
    const Eigen::VectorXd expected = parameters_of(truth).parameters;
    for (Eigen::Index i = 0; i < 4; ++i)
      EXPECT_LT(std::abs(answer.best().fit.parameters[i] - expected[i]),
                4.5 * answer.best().fit.sigma[i]);
  });
}

TEST(Calibrate, AnotherModelCanBeAskedFor) {
  Rng rng{1};
  const BoardViews views = synthetic_views(typical_lens(LensModel::kPinhole), kSize, {}, rng);
  const Calibration answer =
      calibrate(views, kSize, {.model = LensModel::kBrownConrady, .zero = {}});
  EXPECT_EQ(answer.models[answer.recommended].fit.model, LensModel::kPinhole);
  EXPECT_EQ(answer.best().fit.model, LensModel::kBrownConrady);
}

TEST(Calibrate, WhatCannotGiveACameraIsRefusedWithTheReason) {
  Rng rng{1};
  const AnyCamera lens = typical_lens(LensModel::kBrownConrady);
  const auto refusal = [](BoardViews views) {
    return error_of([&] { (void)calibrate(std::move(views), kSize); });
  };

  EXPECT_NE(refusal(synthetic_views(lens, kSize, {.views = 4}, rng)).find("at least 5"),
            std::string::npos);

  // The board faces the camera in all of them, moved to and fro.
  BoardViews facing = synthetic_views(lens, kSize, {.views = 10}, rng);
  for (std::size_t v = 0; v < facing.size(); ++v)
    for (BoardCorner& corner : facing[v].corners) {
      const double z = 0.3 + 0.02 * static_cast<double>(v);
      corner.px = *lens.project({corner.p_W.x() - 0.1, corner.p_W.y() - 0.08, z});
    }
  EXPECT_NE(refusal(facing).find("alike"), std::string::npos) << refusal(facing);

  // One picture, ten times.
  const BoardViews same(10, synthetic_views(lens, kSize, {.views = 1}, rng)[0]);
  EXPECT_NE(refusal(same).find("alike"), std::string::npos) << refusal(same);

  // Corners of another pattern: rows of 8 taken for rows of 6.
  BoardViews wrong = synthetic_views(lens, kSize, {}, rng);
  for (BoardView& view : wrong)
    for (std::size_t i = 0; i < view.corners.size(); ++i)
      view.corners[i].p_W = {0.03 * static_cast<double>(i % 6), 0.03 * static_cast<double>(i / 6)};
  EXPECT_NE(refusal(wrong), "");
}

TEST(TurnUpright, PicturesThatAreStoredTurnedGiveTheUprightCamera) {
  Rng rng{1};
  const BoardViews upright =
      synthetic_views(typical_lens(LensModel::kKannalaBrandt), kSize, {.views = 2}, rng);
  for (const int degrees : {90, 180, 270}) {
    BoardViews turned = upright;
    // Stored pictures were turned clockwise: four turns of a quarter are none.
    for (int turn = 0; turn < 360 - degrees; turn += 90)
      turn_upright(turned, turn % 180 == 0 ? kSize : kSize.reverse(), 90);
    turn_upright(turned, degrees % 180 == 0 ? kSize : kSize.reverse(), degrees);
    for (std::size_t i = 0; i < upright[1].corners.size(); ++i)
      EXPECT_LT((turned[1].corners[i].px - upright[1].corners[i].px).norm(), 1e-9) << degrees;
  }
}

TEST(CornerList, UnitsAndCountingComeFromTheHeader) {
  const gatefly::test::TempFolder folder;
  const auto ours = read_corner_list(
      folder.file("a.csv", "image,X_m,Y_m,u_px,v_px\na.jpg,0.025,0.05,10.5,20\nb.jpg,0,0,1,2\n"));
  const auto matlab = read_corner_list(
      folder.file("b.csv", "view,X_mm,Y_mm,u_px_1based,v_px_1based\n0,25,50,11.5,21\n"));
  ASSERT_EQ(ours.size(), 2U);
  ASSERT_EQ(matlab.size(), 1U);
  EXPECT_EQ(ours[0].image, "a.jpg");
  EXPECT_LT((ours[0].corners[0].px - matlab[0].corners[0].px).norm(), 1e-12);
  EXPECT_LT((ours[0].corners[0].p_W - matlab[0].corners[0].p_W).norm(), 1e-12);
}

TEST(CornerList, WhatIsWrongIsNamed) {
  const gatefly::test::TempFolder folder;
  const auto error = [&](const char* content) {
    return error_of([&] { (void)read_corner_list(folder.file("x.csv", content)); });
  };
  EXPECT_NE(error("image,X_m,Y_m,u_px,v_px\na,0,0,,2\n").find("x.csv:2:4"), std::string::npos);
  EXPECT_NE(error("image,X_m,Y_m,u_px,v_px\na,0,0,nine,2\n").find("nine"), std::string::npos);
  EXPECT_NE(error("image,X_m,Y_m\na,0,0\n").find("u_px"), std::string::npos);
  EXPECT_NE(error("image,X_m,Y_m,u_px,v_px\n").find("no corner"), std::string::npos);
}

/// The corner lists of real cameras; skipped without them.
class RealCorners : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = support::real_data() / "fisheye_calibration";
    if (!std::filesystem::is_directory(folder_))
      GTEST_SKIP() << "no real corner lists at " << folder_ << " (set GATEFLY_DATA)";
  }
  std::filesystem::path folder_;
};

TEST_F(RealCorners, WithTheAuthorsModelTheBebopsCameraIsTheirs) {
  const Calibration answer =
      calibrate(read_corner_list(folder_ / "bebop_front_camera/calib_rot_3_corners.csv"),
                {315, 160}, {.model = {}, .zero = {"p1", "p2"}});
  EXPECT_LE(answer.best().rms_px, 0.20);
  const LensFit& fit = result_of(answer, LensModel::kBrownConrady).fit;
  // fx, fy, cx, cy (from 0), k1, k2, p1, p2, k3 of calib_rot_3, Matlab.
  const Eigen::VectorXd theirs{
      {169.229, 169.453, 149.328, 124.100, -0.32157, 0.10421, 0.0, 0.0, -0.01501}};
  for (Eigen::Index i = 0; i < theirs.size(); ++i)
    EXPECT_NEAR(fit.parameters[i], theirs[i], std::max(fit.sigma[i], 1e-5))
        << parameter_names(fit.model)[static_cast<std::size_t>(i)];
}

TEST_F(RealCorners, AFisheyeOf180DegreesIsFittedToHalfAPixel) {
  const Calibration answer = calibrate(
      read_corner_list(folder_ / "stereo_960x600_9x6_corners_only/corners.csv"), {960, 600});
  EXPECT_LE(answer.best().rms_px, 0.5);
  EXPECT_EQ(name_of(answer.best().fit.model), "kannala-brandt");
}

}  // namespace
}  // namespace gatefly::calibration
