// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/tuning/lens_fit.hpp"

#include <cmath>
#include <deque>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/tasks/tuning/tune.hpp"

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/generators.hpp"

namespace gatefly::tuning {
namespace {

using namespace test;
using Says = GateLens::Says;

constexpr int kWidth = 640, kHeight = 480;
const Eigen::Vector2d kMiddle{0.5 * (kWidth - 1), 0.5 * (kHeight - 1)};
const ColorModel kOrangeGate = ColorModel::described({1.0, 0.4, 0.0});

AnyCamera lens_across(double angle, const Eigen::Vector2d& center = {0, 0}) {
  if (!(angle > 0.0)) return AnyCamera{Pinhole{{400, 400}, kMiddle}};
  KannalaBrandt lens;
  lens.focal_px = Eigen::Vector2d::Constant(kWidth / angle);
  lens.center_px = kMiddle + kWidth * center;
  return AnyCamera{lens};
}

View any_view(Rng& rng) {
  const double x = rng.uniform(1.0, 5.0);
  return {{-x, rng.uniform(-0.8, 0.8) * x, rng.uniform(-0.5, 0.5) * x},
          {.roll = rng.uniform(-0.4, 0.4), .yaw = rng.uniform(-0.6, 0.6)}};
}

/// Sides of so many gates before a lens, each measured with a normal error of its sigma.
std::vector<BowedSide> sides_before(const AnyCamera& lens, int gates, double sigma_px, Rng& rng) {
  const CameraRig rig{lens, camera_mount(0.0), Eigen::Vector3d::Zero()};
  std::vector<BowedSide> sides;
  for (std::size_t gate = 0; gate < static_cast<std::size_t>(gates);) {
    const View view = any_view(rng);
    const auto corners = corners_of(1.0, view, rig);
    if (!corners || !inside_picture(*corners, kWidth, kHeight)) continue;
    const double h = 0.5;
    const std::array<Eigen::Vector3d, 4> p_G{{{0, -h, -h}, {0, h, -h}, {0, h, h}, {0, -h, h}}};
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d &a = (*corners)[i], &b = (*corners)[(i + 1) % 4], d = b - a;
      // where the bar crosses the perpendicular through its chord's middle
      double low = 0.0, high = 1.0;
      Eigen::Vector2d on_bar = a;
      for (int step = 0; step < 40; ++step) {
        const double t = 0.5 * (low + high);
        on_bar = pixel_of((1.0 - t) * p_G[i] + t * p_G[(i + 1) % 4], view, rig).value();
        ((on_bar - a).dot(d) < 0.5 * d.squaredNorm() ? low : high) = t;
      }
      const Eigen::Vector2d inwards = Eigen::Vector2d{-d.y(), d.x()}.normalized();
      sides.push_back({.from = (a - kMiddle) / kWidth,
                       .to = (b - kMiddle) / kWidth,
                       .sag = ((on_bar - a).dot(inwards) + sigma_px * normal(rng)) / kWidth,
                       .sigma = sigma_px / kWidth,
                       .gate = gate});
    }
    ++gate;
  }
  return sides;
}

TEST(FitLens, TheAngleComesBackWithinItsSigma) {
  double squares = 0.0;
  int sets = 0;
  for (const double truth : {100.0 * kDegree, 130.0 * kDegree, 170.0 * kDegree})
    for_all(20, [&](Rng& rng) {
      const GateLens lens = fit_lens(sides_before(lens_across(truth), 15, 0.4, rng));
      ASSERT_EQ(lens.says, Says::kBent);
      EXPECT_LT(lens.angle_sigma, 10.0 * kDegree);
      EXPECT_NEAR(lens.angle, truth, 4.0 * lens.angle_sigma) << lens.angle_sigma / kDegree;
      squares += std::pow((lens.angle - truth) / lens.angle_sigma, 2), ++sets;
    });
  EXPECT_GT(squares / sets, 0.2);  // no sigma of convenience
  EXPECT_LT(squares / sets, 2.0);
}

TEST(FitLens, OutliersMoveItLittle) {
  for_all(20, [](Rng& rng) {
    const double truth = 140.0 * kDegree;
    auto sides = sides_before(lens_across(truth), 20, 0.4, rng);
    for (BowedSide& side : sides)
      if (rng.uniform(0, 1) < 0.15) side.sag += rng.uniform(-10.0, 10.0) / kWidth;
    const GateLens lens = fit_lens(sides);
    ASSERT_EQ(lens.says, Says::kBent);
    EXPECT_NEAR(lens.angle, truth, std::max(5.0 * kDegree, 4.0 * lens.angle_sigma));
  });
}

TEST(FitLens, NoBendIsClaimedOfAStraightLens) {
  int straight = 0;
  for_all(40, [&](Rng& rng) {
    const GateLens lens = fit_lens(sides_before(lens_across(0.0), 20, 0.4, rng));
    EXPECT_NE(lens.says, Says::kBent) << lens.angle / kDegree;
    straight += lens.says == Says::kStraight;
  });
  EXPECT_GE(straight, 30);
}

TEST(FitLens, OfFewGatesSmallOnesAndScatterNothingCanBeTold) {
  for_all(20, [](Rng& rng) {
    EXPECT_EQ(fit_lens({}).says, Says::kNothing);
    EXPECT_EQ(fit_lens(sides_before(lens_across(150.0 * kDegree), 3, 0.4, rng)).says,
              Says::kNothing);
    auto small = sides_before(lens_across(150.0 * kDegree), 8, 0.4, rng);
    for (BowedSide& side : small) {
      const Eigen::Vector2d middle = 0.5 * (side.from + side.to);
      side.from = middle + 0.1 * (side.from - middle), side.to = middle + 0.1 * (side.to - middle);
      side.sag = 0.4 * normal(rng) / kWidth;
    }
    EXPECT_EQ(fit_lens(small).says, Says::kNothing);
    auto scatter = sides_before(lens_across(0.0), 8, 0.4, rng);
    for (BowedSide& side : scatter) side.sag = rng.uniform(-15.0, 15.0) / kWidth;
    EXPECT_EQ(fit_lens(scatter).says, Says::kNothing);
  });
}

TEST(FitLens, ACentreIsSaidWhereTheGatesShowItAndIsElseTheMiddle) {
  for_all(10, [](Rng& rng) {
    const double truth = 150.0 * kDegree;
    const Eigen::Vector2d off{0.05, -0.04};
    const GateLens lens = fit_lens(sides_before(lens_across(truth, off), 40, 0.3, rng));
    ASSERT_TRUE(lens.knows_center);
    EXPECT_LT((lens.center - off).cwiseQuotient(lens.center_sigma).norm(), 5.0);
    EXPECT_NEAR(lens.angle, truth, 5.0 * lens.angle_sigma);
    const GateLens middle = fit_lens(sides_before(lens_across(truth), 40, 0.3, rng));
    EXPECT_EQ(middle.center, (Eigen::Vector2d{0, 0}));
  });
}

/// Ten pictures of gates before a lens, or of none.
struct LensAlbum {
  std::deque<std::vector<std::uint8_t>> bytes;
  std::vector<LabelledImage> pictures;

  LensAlbum(const AnyCamera& lens, bool gates, std::uint64_t seed) {
    Rng rng{seed};
    const CameraRig rig{lens, camera_mount(0.0), Eigen::Vector3d::Zero()};
    while (pictures.size() < 10) {
      const View view = any_view(rng);
      const auto corners = corners_of(1.0, view, rig);
      if (!corners || !inside_picture(*corners, kWidth, kHeight, 10.0)) continue;
      Canvas canvas(kWidth, kHeight);
      if (gates) canvas.draw_gate(view, rig);
      canvas.add_noise(rng, 8.0, 4.0);
      bytes.push_back(canvas.yuv444());
      pictures.push_back({{bytes.back().data(), PixelFormat::kYuv444, kWidth, kHeight}, {}});
    }
  }
};

TEST(Tune, TenPicturesSayWhichLensTheyWereTakenWith) {
  for (const double truth : {110.0 * kDegree, 150.0 * kDegree}) {
    const LensAlbum album{lens_across(truth), true, 21};
    const Tuned tuned = tune_to_description(album.pictures, kOrangeGate, {}, 0.02);
    ASSERT_TRUE(tuned.learnt);
    ASSERT_EQ(tuned.lens.says, Says::kBent);
    EXPECT_NEAR(tuned.lens.angle, truth, std::max(4.0 * kDegree, 3.0 * tuned.lens.angle_sigma));
    EXPECT_LT(tuned.lens.angle_sigma, 5.0 * kDegree);
  }
}

TEST(Tune, ClaimsNoBendOfAStraightLensNorOfPicturesWithoutGates) {
  const LensAlbum straight{lens_across(0.0), true, 22}, none{lens_across(0.0), false, 23};
  const Tuned tuned = tune_to_description(straight.pictures, kOrangeGate, {}, 0.02);
  ASSERT_TRUE(tuned.learnt);
  EXPECT_EQ(tuned.lens.says, Says::kStraight);
  EXPECT_EQ(tune_to_description(none.pictures, kOrangeGate, {}, 0.02).lens.says, Says::kNothing);
}

TEST(Tune, AsksNothingOfALensThatWasNamed) {
  const LensAlbum album{lens_across(150.0 * kDegree), true, 24};
  const Judging judging{.detector = {.lens = {lens_across(150.0 * kDegree), kWidth, kHeight}}};
  const Tuned tuned = tune_to_description(album.pictures, kOrangeGate, judging, 0.02);
  EXPECT_EQ(tuned.lens.says, Says::kNothing);
  EXPECT_EQ(tuned.lens.sides, 0);
  EXPECT_EQ(as_tuned(judging, tuned).detector.lens.width, kWidth);
}

}  // namespace
}  // namespace gatefly::tuning
