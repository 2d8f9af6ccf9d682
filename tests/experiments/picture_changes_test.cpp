// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/picture_changes.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/experiments/color_changes.hpp"
#include "gatefly/experiments/shape_changes.hpp"
#include "gatefly/files/scoring.hpp"

namespace gatefly::experiments {
namespace {

using Eigen::Vector2d;

using Rgb = std::array<int, 3>;
constexpr Rgb kWall{90, 100, 110}, kOrange{230, 120, 40};

UprightPicture plain(int width, int height, const Rgb& color) {
  UprightPicture picture{.width = width, .height = height};
  for (int i = 0; i < width * height; ++i)
    for (const int value : color) picture.bytes.push_back(static_cast<std::uint8_t>(value));
  return picture;
}

void paint(UprightPicture& picture, int u0, int v0, int u1, int v1, const Rgb& color) {
  for (int v = v0; v <= v1; ++v)
    for (int u = u0; u <= u1; ++u)
      for (std::size_t c = 0; c < 3; ++c)
        picture.bytes[picture.at(u, v) + c] = static_cast<std::uint8_t>(color[c]);
}

/// An orange frame of bars 3 px wide about the label.
UprightPicture gate_at(int left, int top, int side, int width = 160, int height = 200) {
  UprightPicture picture = plain(width, height, kWall);
  const int right = left + side, bottom = top + side;
  paint(picture, left - 1, top - 1, right + 1, bottom + 1, kOrange);
  paint(picture, left + 2, top + 2, right - 2, bottom - 2, kWall);
  const double l = left, t = top, r = right, b = bottom;
  picture.gates = {Quad{Vector2d{l, t}, {r, t}, {r, b}, {l, b}}};
  return picture;
}

Rgb color_at(const UprightPicture& picture, int u, int v) {
  const std::size_t i = picture.at(u, v);
  return {picture.bytes[i], picture.bytes[i + 1], picture.bytes[i + 2]};
}

bool is_orange(const UprightPicture& picture, const Vector2d& p) {
  const Rgb c =
      color_at(picture, static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
  return c[0] - c[2] > 100;
}

std::array<double, 3> mean_of(const UprightPicture& picture) {
  std::array<double, 3> mean{};
  for (std::size_t i = 0; i < picture.bytes.size(); ++i)
    mean[i % 3] += 3.0 * picture.bytes[i] / static_cast<double>(picture.bytes.size());
  return mean;
}

const PictureChange& change_of(const std::string& key) {
  const auto changes = picture_changes();
  return *std::find_if(changes.begin(), changes.end(),
                       [&](const PictureChange& change) { return key == change.key; });
}

/// Every middle of a bar of every labelled gate is orange, every opening's middle is not.
void expect_labels_on_gates(const UprightPicture& picture) {
  for (const Quad& label : picture.gates) {
    EXPECT_FALSE(is_orange(picture, center(label)));
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_TRUE(is_orange(picture, 0.5 * (label[i] + label[(i + 1) % 4]))) << "bar " << i;
  }
}

TEST(PictureChanges, HaveKeysOfTheirOwnAndBeginWithNothing) {
  std::set<std::string> keys;
  for (const PictureChange& change : picture_changes())
    EXPECT_TRUE(keys.insert(change.key).second) << change.key;
  const UprightPicture picture = gate_at(40, 60, 60);
  EXPECT_EQ(picture_changes().front().apply(picture)->bytes, picture.bytes);
}

TEST(PictureChanges, AreTheSameEveryTime) {
  const UprightPicture picture = gate_at(40, 60, 60);
  for (const PictureChange& change : picture_changes()) {
    const auto once = change.apply(picture), again = change.apply(picture);
    ASSERT_TRUE(once && again) << change.key;
    EXPECT_EQ(once->bytes, again->bytes) << change.key;
    EXPECT_EQ(once->bytes.size(), image_bytes(once->format, once->width, once->height))
        << change.key;
  }
}

TEST(PictureChanges, LabelsStayOnTheirGates) {
  for (const char* key : {"nothing", "luma-blur-2", "size-0.5", "size-2", "size-4", "turned-15",
                          "turned-30", "flipped", "noise-8", "second-gate"}) {
    SCOPED_TRACE(key);
    const auto changed = change_of(key).apply(gate_at(40, 60, 60));
    ASSERT_TRUE(changed);
    ASSERT_FALSE(changed->gates.empty());
    expect_labels_on_gates(*changed);
  }
}

TEST(PictureChanges, SurviveNastyPictures) {
  const double far = 1e4;
  for (UprightPicture picture : {plain(1, 1, kOrange), plain(1, 9, kWall), plain(9, 1, kWall)}) {
    picture.gates = {Quad{Vector2d{0, 0}, {0, 0}, {0, 0}, {0, 0}},
                     Quad{Vector2d{-far, -far}, {far, -far}, {far, far}, {-far, far}}};
    for (const PictureChange& change : picture_changes()) {
      const auto changed = change.apply(picture);
      if (!changed) continue;
      EXPECT_EQ(changed->bytes.size(),
                image_bytes(changed->format, changed->width, changed->height))
          << change.key;
    }
  }
}

TEST(UprightPicture, TurnsStoredPixelsAndKeepsTheirColours) {
  const UprightPicture picture = gate_at(4, 8, 12, 32, 40);
  const UprightPicture again = upright_rgb(picture.view());
  for (std::size_t i = 0; i < picture.bytes.size(); ++i)
    ASSERT_NEAR(again.bytes[i], picture.bytes[i], 2) << i;  // through 8-bit Y'CbCr
  const UprightPicture turned =
      upright_rgb(Image(picture.bytes.data(), PixelFormat::kRgb, 32, 40, 90));
  EXPECT_EQ(turned.width, 40);
  EXPECT_NEAR(color_at(turned, 8, 31 - 4)[0], kOrange[0], 2);
}

TEST(ColorChanges, BrightnessHalvesEveryColour) {
  const UprightPicture half = *change_of("bright-0.5").apply(plain(3, 2, {200, 101, 0}));
  EXPECT_EQ(color_at(half, 2, 1), (Rgb{100, 51, 0}));
}

TEST(ColorChanges, WhiteBalanceStopsAtFullScale) {
  const UprightPicture bluer = *change_of("white-bluer").apply(plain(1, 1, {100, 100, 220}));
  EXPECT_EQ(color_at(bluer, 0, 0), (Rgb{80, 100, 255}));
}

TEST(ColorChanges, GammaKeepsBlackAndWhiteAndTwoDarkens) {
  EXPECT_EQ(color_at(with_gamma(plain(1, 1, {0, 255, 128}), 2.0), 0, 0), (Rgb{0, 255, 64}));
  EXPECT_EQ(color_at(with_gamma(plain(1, 1, {0, 255, 64}), 0.5), 0, 0), (Rgb{0, 255, 128}));
}

TEST(ColorChanges, SaturationKeepsLumaAndShrinksChroma) {
  const auto as_ycc = [](const Rgb& c) {
    return ycc_of({double(c[0]), double(c[1]), double(c[2])});
  };
  const auto before = as_ycc(kOrange),
             after = as_ycc(color_at(saturated(plain(1, 1, kOrange), 0.3), 0, 0));
  EXPECT_NEAR(after[0], before[0], 0.7);
  EXPECT_NEAR(after[1] - 128.0, 0.3 * (before[1] - 128.0), 0.7);
  EXPECT_NEAR(after[2] - 128.0, 0.3 * (before[2] - 128.0), 0.7);
}

TEST(ColorChanges, HueTurnsTwentyDegreesAndBack) {
  const UprightPicture there = with_hue_turned(plain(1, 1, kOrange), 20.0);
  EXPECT_NE(color_at(there, 0, 0), kOrange);
  const Rgb back = color_at(with_hue_turned(there, -20.0), 0, 0);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(back[c], kOrange[c], 2);
}

TEST(ColorChanges, BlurAndMotionKeepTheMean) {
  const UprightPicture picture = gate_at(60, 80, 40);
  for (const UprightPicture& changed :
       {blurred(picture, 2.0), blurred(picture, 3.0, Blurred::kChroma), moved_across(picture, 9),
        moved_across(picture, 15), moved_down(picture, 9)})
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean_of(changed)[c], mean_of(picture)[c], 0.15);
}

TEST(ColorChanges, MotionSmearsOnePixelOverNine) {
  UprightPicture picture = plain(31, 31, {0, 0, 0});
  paint(picture, 15, 15, 15, 15, {180, 180, 180});
  const UprightPicture across = moved_across(picture, 9), down = moved_down(picture, 9);
  EXPECT_EQ(color_at(across, 11, 15)[0], 20);
  EXPECT_EQ(color_at(across, 19, 15)[0], 20);
  EXPECT_EQ(color_at(across, 20, 15)[0], 0);
  EXPECT_EQ(color_at(across, 15, 14)[0], 0);
  EXPECT_EQ(color_at(down, 15, 19)[0], 20);
  EXPECT_EQ(color_at(down, 14, 15)[0], 0);
}

TEST(ColorChanges, ABlurOfLumaLeavesChroma) {
  const UprightPicture picture = gate_at(60, 80, 40);
  const UprightPicture luma = blurred(picture, 2.0, Blurred::kLuma),
                       chroma = blurred(picture, 2.0, Blurred::kChroma);
  const auto ycc_at = [](const UprightPicture& p) {
    const Rgb c = color_at(p, 80, 79);  // the upper edge of the top bar
    return ycc_of({double(c[0]), double(c[1]), double(c[2])});
  };
  const auto before = ycc_at(picture);
  EXPECT_GT(std::abs(ycc_at(luma)[0] - before[0]), 5.0);
  EXPECT_NEAR(ycc_at(luma)[2], before[2], 2.0);
  EXPECT_NEAR(ycc_at(chroma)[0], before[0], 2.0);
  EXPECT_LT(ycc_at(chroma)[2], before[2] - 20.0);
}

TEST(ColorChanges, NoiseHasItsSigmaAndNoMean) {
  const UprightPicture noise = noisy(plain(200, 100, {128, 128, 128}), 8.0);
  double sum = 0.0, squares = 0.0;
  for (const std::uint8_t value : noise.bytes)
    sum += value - 128.0, squares += (value - 128.0) * (value - 128.0);
  const auto count = static_cast<double>(noise.bytes.size());
  EXPECT_NEAR(sum / count, 0.0, 0.1);  // 60,000 draws: sigma of the mean .033
  EXPECT_NEAR(std::sqrt(squares / count), 8.0, 0.1);
}

TEST(ColorChanges, A420JpegLosesTheColourOfThinBarsA444KeepsIt) {
  UprightPicture picture = plain(64, 64, kWall);
  paint(picture, 31, 0, 31, 63, kOrange);
  const auto red = [&](files::ChromaSampling sampling) {
    const UprightPicture stored = through_jpeg(picture, 95, sampling);
    EXPECT_EQ(stored.format, PixelFormat::kYuv444);
    return int{stored.view().at(31, 32).v};
  };
  EXPECT_GT(red(files::ChromaSampling::k444), red(files::ChromaSampling::k420) + 15);
}

TEST(ShapeChanges, SizesKeepTheMeanAndScaleLabels) {
  const UprightPicture picture = gate_at(60, 80, 40);
  for (const double factor : {0.5, 2.0, 4.0}) {
    const UprightPicture changed = resized(picture, factor);
    EXPECT_EQ(changed.width, static_cast<int>(factor * 160));
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(mean_of(changed)[c], mean_of(picture)[c], 0.15) << factor;
    EXPECT_NEAR(area(changed.gates[0]), factor * factor * 1600.0, 1e-6);
  }
}

TEST(ShapeChanges, APictureFlippedTwiceIsItself) {
  const UprightPicture picture = gate_at(20, 60, 60), once = flipped(picture);
  EXPECT_NEAR(center(once.gates[0]).x(), 159.0 - 50.0, 1e-9);
  EXPECT_EQ(flipped(once).bytes, picture.bytes);
}

TEST(ShapeChanges, AGateThatIsTurnedOutOfThePictureIsNotToBeFound) {
  const UprightPicture turned = rotated(gate_at(5, 5, 40), 30.0);
  EXPECT_TRUE(turned.gates.empty());
  EXPECT_EQ(turned.ignored.size(), 1u);
  EXPECT_EQ(rotated(gate_at(60, 80, 40), 30.0).gates.size(), 1u);
}

TEST(ShapeChanges, TheSecondGateIsSmallerAndHidesNothing) {
  const UprightPicture picture = gate_at(20, 60, 60);
  const auto both = with_second_gate(picture, 0.7);
  ASSERT_TRUE(both);
  ASSERT_EQ(both->gates.size(), 2u);
  EXPECT_NEAR(area(both->gates[1]), 0.49 * 3600.0, 1e-6);
  EXPECT_EQ(files::polygon_shared_area(both->gates[0], both->gates[1]), 0.0);
  for (int v = 59; v <= 121; ++v)
    for (int u = 19; u <= 81; ++u)
      ASSERT_EQ(color_at(*both, u, v), color_at(picture, u, v)) << u << ' ' << v;
}

TEST(ShapeChanges, WithoutRoomOrWholeGateThereIsNoSecondGate) {
  EXPECT_FALSE(with_second_gate(gate_at(10, 10, 60, 80, 80), 0.7));
  EXPECT_FALSE(with_second_gate(plain(100, 100, kWall), 0.7));
  UprightPicture cut = gate_at(20, 60, 60);
  for (Vector2d& corner : cut.gates[0]) corner.x() -= 40.0;
  EXPECT_FALSE(with_second_gate(cut, 0.7));
}

TEST(ShapeChanges, ABandHidesTheMiddleOfItsBarAndNoOther) {
  const UprightPicture picture = gate_at(40, 60, 60);
  const std::array<Vector2d, 4> middles{Vector2d{70, 60}, {100, 90}, {70, 120}, {40, 90}};
  for (std::size_t bar = 0; bar < 4; ++bar) {
    const UprightPicture band = with_band(picture, static_cast<Bar>(bar), 1.0 / 3.0, 0.05);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(is_orange(band, middles[i]), i != bar) << bar << ' ' << i;
      EXPECT_TRUE(is_orange(band, picture.gates[0][i])) << "corner " << i;
    }
    EXPECT_FALSE(is_orange(band, center(picture.gates[0])));
  }
}

}  // namespace
}  // namespace gatefly::experiments
