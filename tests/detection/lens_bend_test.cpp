// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/lens_bend.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/geometry/math.hpp"

#include "support/all_detectors.hpp"
#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/orange.hpp"
#include "support/worst_corner.hpp"

namespace gatefly {
namespace {

using namespace test;

AnyCamera equidistant(double focal_px) {
  KannalaBrandt lens;
  lens.focal_px = {focal_px, focal_px}, lens.center_px = {319.5, 239.5};
  return {lens};
}

struct Shipped {
  const char* name;
  PictureLens lens;
};

// Those of cameras/ that bend, and the wide one at 130 and 170 degrees.
std::vector<Shipped> shipped_lenses() {
  const BrownConrady brown{
      {169.229, 169.453}, {149.328, 124.1}, {-0.32157, 0.10421, 0.0, 0.0, -0.01501}};
  return {{"bebop", {AnyCamera{DhaneFisheye{}}, 315, 160}},
          {"bebop-brown", {AnyCamera{brown}, 315, 160}},
          {"wide-usb, 130 degrees", {equidistant(282.1), 640, 480}},
          {"wide-usb", {equidistant(244.5), 640, 480}},
          {"wide-usb, 170 degrees", {equidistant(215.7), 640, 480}}};
}

// Size only.
Image picture_through(const PictureLens& lens) {
  static const std::vector<std::uint8_t> kBytes(3 * 640 * 480, 128);
  return {kBytes.data(), PixelFormat::kYuv444, lens.width, lens.height};
}

bool is_in_view(const std::optional<Eigen::Vector2d>& px, const PictureLens& lens) {
  return px && px->x() >= 0.0 && px->y() >= 0.0 && px->x() <= lens.width - 1.0 &&
         px->y() <= lens.height - 1.0;
}

double distance_from_curve(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b, const Eigen::Vector2d& sag) {
  double least = 1e9;
  for (int k = 0; k <= 2000; ++k) {
    const double t = k / 2000.0;
    least = std::min(least, (a + t * (b - a) + 4.0 * t * (1.0 - t) * sag - p).norm());
  }
  return least;
}

TEST(LensBend, ItsTablesAreTheLens) {
  for (const auto& [name, lens] : shipped_lenses()) {
    const LensBend bend{lens};
    ASSERT_FALSE(bend.is_straight()) << name;
    for_all(400, [&, name = name, lens = lens](Rng& rng) {
      const Eigen::Vector2d px{rng.uniform(0, lens.width - 1), rng.uniform(0, lens.height - 1)};
      const auto bearing_C = lens.model->bearing(px);
      if (!bearing_C || bearing_C->z() < 0.1) return not_a_case();
      const auto ray = bend.ray(px);
      ASSERT_TRUE(ray);
      EXPECT_LT((*ray - *bearing_C).norm(), 3e-4) << name;
      const auto back = bend.pixel(2.0 * *bearing_C);
      ASSERT_TRUE(back);
      EXPECT_LT((*back - px).norm(), 0.02) << name;
    });
  }
}

// A bar of up to half of the picture's width, anywhere in view: its points lie on the parabola
// through its ends and its sag.
TEST(LensBend, AStraightBarLiesOnItsCurve) {
  for (const auto& [name, lens] : shipped_lenses()) {
    const LensBend bend{lens};
    const SideCurves curves{bend, picture_through(lens)};
    ASSERT_TRUE(curves.bent());
    double worst = 0.0, most_sag = 0.0;
    for_all(300, [&, lens = lens](Rng& rng) {
      const Eigen::Vector3d p_C{rng.uniform(-3, 3), rng.uniform(-2, 2), rng.uniform(0.3, 4.0)};
      const Eigen::Vector3d q_C = p_C + rng.uniform(0.5, 1.0) * any_direction(rng);
      const auto a = lens.model->project(p_C), b = lens.model->project(q_C);
      if (!is_in_view(a, lens) || !is_in_view(b, lens) || (*b - *a).norm() < 10.0 ||
          (*b - *a).norm() > 0.5 * lens.width)
        return;
      const Eigen::Vector2d sag = curves.sag(*a, *b);
      most_sag = std::max(most_sag, sag.norm());
      for (int k = 1; k < 16; ++k) {
        const auto on_bar = lens.model->project(p_C + k / 16.0 * (q_C - p_C));
        if (on_bar) worst = std::max(worst, distance_from_curve(*on_bar, *a, *b, sag));
      }
    });
    EXPECT_LT(worst, 0.4) << name;
    EXPECT_GT(most_sag, 5.0 * worst) << name << ": the test says little";
  }
}

TEST(LensBend, BarsCrossWhereTheirImagesDo) {
  for (const auto& [name, lens] : shipped_lenses()) {
    const LensBend bend{lens};
    const SideCurves curves{bend, picture_through(lens)};
    for_all(100, [&, name = name, lens = lens](Rng& rng) {
      const Eigen::Vector3d met_C{rng.uniform(-2, 2), rng.uniform(-1.5, 1.5), rng.uniform(1, 3)};
      const Eigen::Vector3d along_C = any_direction(rng), across_C = any_direction(rng);
      const auto met = lens.model->project(met_C);
      const auto a = lens.model->project(met_C - 0.5 * along_C),
                 b = lens.model->project(met_C - 0.1 * along_C),
                 c = lens.model->project(met_C + 0.1 * across_C),
                 d = lens.model->project(met_C + 0.5 * across_C);
      if (!is_in_view(met, lens) || !a || !b || !c || !d) return;
      const auto crossing = curves.crossing(*a, *b, *c, *d);
      if (!crossing) return;  // nearly parallel
      EXPECT_LT((*crossing - *met).norm(), 0.1) << name;
    });
  }
}

TEST(LensBend, OuterCornersAreThoseOfALargerSquareInSpace) {
  const PictureLens lens{equidistant(244.5), 640, 480};
  const LensBend bend{lens};
  const SideCurves curves{bend, picture_through(lens)};
  const CameraRig rig{*lens.model, camera_mount(0.0), Eigen::Vector3d::Zero()};
  for_all(100, [&](Rng& rng) {
    const View view{{-rng.uniform(0.7, 4.0), rng.uniform(-1.0, 1.0), rng.uniform(-0.5, 0.5)},
                    {.roll = rng.uniform(-0.5, 0.5), .yaw = rng.uniform(-0.7, 0.7)}};
    const auto middle = corners_of(0.95, view, rig), outer = corners_of(1.0, view, rig);
    if (!middle || !outer) return not_a_case();
    EXPECT_LT(worst_corner(curves.scaled(*middle, 1.0 / 0.95), *outer), 0.1);
  });
}

TEST(LensBend, ALensWithoutBendIsStraight) {
  EXPECT_TRUE(LensBend{}.is_straight());
  EXPECT_TRUE(LensBend{PictureLens{}}.is_straight());
  EXPECT_TRUE((LensBend{{AnyCamera{Pinhole{}}, 315, 160}}.is_straight()));
  EXPECT_TRUE((LensBend{{AnyCamera{DhaneFisheye{.k = 1.0}}, 315, 160}}.is_straight()));
}

TEST(LensBend, HalfAPictureBendsHalfAsMuchAndAnotherShapeNotAtAll) {
  const LensBend bend{{equidistant(244.5), 640, 480}};
  const SideCurves whole{bend, picture_through({{}, 640, 480})},
      half{bend, picture_through({{}, 320, 240})}, other{bend, picture_through({{}, 315, 160})};
  const Eigen::Vector2d a{40.5, 60.5}, b{440.5, 40.5};
  const Eigen::Vector2d sag = whole.sag(a, b), half_sag = half.sag(to_cells(a, 2), to_cells(b, 2));
  EXPECT_GT(sag.norm(), 20.0);
  EXPECT_LT((half_sag - 0.5 * sag).norm(), 1e-9);
  EXPECT_FALSE(other.bent());
  EXPECT_EQ(other.sag(a, b).norm(), 0.0);
}

TEST(LensBend, FarOutsideNothingBendsAndNoNumberBreaks) {
  for (const auto& [name, lens] : shipped_lenses()) {
    const LensBend bend{lens};
    const SideCurves curves{bend, picture_through(lens)};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double far : {1e3, 1e6, 1e12, 1e300, nan})
      for (const Eigen::Vector2d& p : {Eigen::Vector2d{far, 0}, {0, -far}, {-far, far}}) {
        EXPECT_TRUE(curves.sag(p, {100, 100}).allFinite()) << name;
        EXPECT_TRUE(curves.sag(p, -p).allFinite() || std::isnan(far)) << name;
        const auto met = curves.crossing(p, {100, 100}, {50, 50}, {20, 80});
        EXPECT_TRUE(!met || met->allFinite()) << name;
      }
  }
}

/// A gate as a lens of so many degrees across draws it, 640 x 480.
struct WideView {
  CameraRig rig;
  View view;
  std::vector<std::uint8_t> bytes;

  WideView(double focal_px, const View& seen, Rng& rng)
      : rig{equidistant(focal_px), camera_mount(0.0), Eigen::Vector3d::Zero()}, view{seen} {
    Canvas canvas(640, 480);
    canvas.draw_gate(view, rig);
    canvas.add_noise(rng, 4.0, 2.0);
    bytes = canvas.yuv444();
  }
  [[nodiscard]] Image image() const { return {bytes.data(), PixelFormat::kYuv444, 640, 480}; }
  [[nodiscard]] std::optional<Quad> truth() const { return corners_of(1.0, view, rig); }
};

// Gates of 60 to 300 px, anywhere in view of lenses of 130, 150 and 170 degrees.
TEST(CurvedSides, AGateBeforeAWideLensIsFoundToHalfAPixel) {
  for (const double focal_px : {282.1, 244.5, 215.7}) {
    const PictureLens lens{equidistant(focal_px), 640, 480};
    GateDetector ours{{.lens = lens}}, careful{{.lens = lens}, DetectorMode::kCareful};
    int views = 0;
    std::vector<double> fast_errors, careful_errors;
    for_all(15, [&](Rng& rng) {
      const double x = rng.uniform(0.9, 4.0);
      const WideView picture{focal_px,
                             {{-x, rng.uniform(-0.7, 0.7) * x, rng.uniform(-0.4, 0.4) * x},
                              {.roll = rng.uniform(-0.4, 0.4), .yaw = rng.uniform(-0.3, 0.3)}},
                             rng};
      const auto truth = picture.truth();
      if (!truth || !inside_picture(*truth, 640, 480, 20.0)) return not_a_case();
      ++views;
      for (const auto& [detector, errors] :
           {std::pair{&ours, &fast_errors}, {&careful, &careful_errors}}) {
        const auto gates = detector->look(picture.image(), kOrange).gates;
        errors->push_back(gates.empty() ? 1e9 : worst_corner(gates[0].corners_px, *truth));
      }
    });
    for (std::vector<double>* errors : {&fast_errors, &careful_errors}) {
      std::sort(errors->begin(), errors->end());
      EXPECT_LT(errors->at(errors->size() / 2), 0.5) << focal_px;
      EXPECT_LT(errors->at(errors->size() * 4 / 5), 1.0) << focal_px;
    }
    EXPECT_LT(careful_errors.back(), 1.0) << focal_px << ", " << views << " views";
  }
}

// Straight sides beside bars that bow; what nobody knows is seen from the bars.
TEST(CurvedSides, TheCornersOfANearGateAreBestWithItsLensAndNotFarOffWithoutAny) {
  const auto worst = [](const PictureLens& lens, const WideView& picture) {
    GateDetector detector{{.lens = lens}};
    const auto gates = detector.look(picture.image(), kOrange).gates;
    return gates.empty() ? 1e9 : worst_corner(gates[0].corners_px, picture.truth().value());
  };
  for_all(5, [&](Rng& rng) {
    const WideView picture{
        244.5, {{-1.3, rng.uniform(-0.2, 0.2), 0.1}, {.roll = rng.uniform(-0.2, 0.2)}}, rng};
    EXPECT_LT(worst({equidistant(244.5), 640, 480}, picture), 0.7);
    EXPECT_LT(worst({}, picture), 2.5);
    EXPECT_GT(worst({AnyCamera{Pinhole{}}, 640, 480}, picture), 4.0);
  });
}

// Gates of 250 to 450 px, whose sides bow by up to a bar's width and more.
TEST(CurvedSides, ANearGateIsFoundThoughNobodyNamedTheLens) {
  GateDetector unnamed;
  for (const double focal_px : {282.1, 215.7}) {
    int views = 0, found = 0;
    for_all(15, [&](Rng& rng) {
      const double x = rng.uniform(0.55, 0.8);
      const WideView picture{focal_px,
                             {{-x, rng.uniform(-0.5, 0.5) * x, rng.uniform(-0.3, 0.3) * x},
                              {.roll = rng.uniform(-0.4, 0.4), .yaw = rng.uniform(-0.4, 0.4)}},
                             rng};
      const auto truth = picture.truth();
      if (!truth || !inside_picture(*truth, 640, 480, 8.0)) return;
      ++views;
      const auto gates =
          unnamed.look(picture.image(), kOrange, {.gates = LookFor::Gates::kBest}).gates;
      found += !gates.empty() && overlaps(gates[0].corners_px, *truth, 0.7);
    });
    EXPECT_GE(views, 8) << focal_px;
    EXPECT_GE(found, 0.85 * views) << focal_px << ", " << views << " views";
  }
}

// One angle means the same lens in pictures of any size, about the middle of any shape.
TEST(LensBend, OneAngleBendsPicturesOfAnySizeAndShapeAboutTheirMiddle) {
  const LensBend angle{equidistant_lens(640 / 244.5)}, named{{equidistant(244.5), 640, 480}};
  const Eigen::Vector2d a{40.5, 60.5}, b{440.5, 40.5};
  const SideCurves as_named{named, picture_through({{}, 640, 480})};
  const Eigen::Vector2d sag = as_named.sag(a, b);
  EXPECT_LT((SideCurves{angle, picture_through({{}, 640, 480})}.sag(a, b) - sag).norm(), 1e-6);
  const SideCurves half{angle, picture_through({{}, 320, 240})};
  EXPECT_LT((half.sag(to_cells(a, 2), to_cells(b, 2)) - 0.5 * sag).norm(), 1e-6);
  const Eigen::Vector2d down{0, -60};  // from the middle of 640 x 480 to that of 640 x 360
  const SideCurves lower{angle, picture_through({{}, 640, 360})};
  EXPECT_LT((lower.sag(a + down, b + down) - sag).norm(), 1e-6);
  EXPECT_TRUE(LensBend{equidistant_lens(0.0)}.is_straight());
  EXPECT_TRUE(LensBend{equidistant_lens(0.0)}.is_known());
}

// Which lens it was is not known of a picture of another shape.
TEST(CurvedSides, AStraightLensAndAPictureOfAnotherShapeChangeNoBit) {
  GateDetector none, other_shape{{.lens = {equidistant(244.5), 640, 480}}},
      pinhole{{.lens = {AnyCamera{Pinhole{}}, 315, 160}}},
      hardly_bent{{.lens = {AnyCamera{DhaneFisheye{.k = 1.0}}, 315, 160}}};
  int found = 0;
  for_all(20, [&](Rng& rng) {
    Canvas canvas(315, 160);
    canvas.draw_gate(
        {{-rng.uniform(1.5, 5.0), rng.uniform(-0.5, 0.5), 0.0}, {.roll = rng.uniform(-0.6, 0.6)}},
        bebop_rig());
    canvas.add_noise(rng);
    const auto bytes = canvas.yuv444();
    const Image image{bytes.data(), PixelFormat::kYuv444, 315, 160};
    const auto gates_of = [&](GateDetector& detector) {
      return detector.look(image, kOrange, {.gates = LookFor::Gates::kAll}).gates;
    };
    for (const auto& [a, b] : {std::pair{&none, &other_shape}, {&pinhole, &hardly_bent}}) {
      const auto gates = gates_of(*a), same = gates_of(*b);
      ASSERT_EQ(same.size(), gates.size());
      for (std::size_t i = 0; i < gates.size(); ++i) {
        EXPECT_EQ(same[i].corners_px, gates[i].corners_px);
        EXPECT_EQ(same[i].fitness, gates[i].fitness);
      }
    }
    const auto unknown = gates_of(none), straight = gates_of(pinhole);
    if (unknown.empty() || straight.empty()) return;
    ++found;
    EXPECT_EQ(unknown[0].fitness, straight[0].fitness);
    EXPECT_LT(worst_corner(unknown[0].corners_px, straight[0].corners_px), 2.0);
  });
  EXPECT_GE(found, 15);
}

// Noise, with bars of the gate's colour across and beyond the lens' field of view.
TEST(CurvedSides, AnyPictureGetsAPossibleAnswer) {
  AllDetectors all;
  for_all(30, [&](Rng& rng) {
    const int width = 2 * static_cast<int>(rng.uniform(1, 100)),
              height = static_cast<int>(rng.uniform(1, 160));
    Canvas canvas(width, height);
    canvas.add_noise(rng, 60.0, 60.0);
    const int left = static_cast<int>(rng.uniform(0, width));
    canvas.paint(left, left + 6, 0, height, {120, 90, 190});
    const auto bytes = canvas.yuv444();
    DetectorSettings settings;
    const double focal_px = rng.uniform(10.0, 100.0);
    KannalaBrandt lens;
    lens.focal_px = {focal_px, focal_px};
    lens.center_px = {rng.uniform(0, width), rng.uniform(0, height)};
    settings.search = {.min_score = -2.0, .lens = {AnyCamera{lens}, width, height}};
    EXPECT_EQ(all.complaint({bytes.data(), PixelFormat::kYuv444, width, height}, settings), "");
  });
}

}  // namespace
}  // namespace gatefly
