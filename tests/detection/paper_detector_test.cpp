// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/paper/paper_detector.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "support/for_all.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;

/// A grey picture to paint in a colour that lies in both detectors' boxes.
class PaperPicture {
 public:
  PaperPicture(int width, int height) : width_{width}, height_{height} {
    for (int i = 0; i < width * height; ++i) bytes_.insert(bytes_.end(), {110, 128, 128});
  }
  void paint(int u0, int v0, int u1, int v1, bool gate = true) {
    for (int v = v0; v <= v1; ++v)
      for (int u = u0; u <= u1; ++u) set(u, v, gate);
  }
  /// A frame of bars 1 px wide: corners at (u, v) and (u + side, v + side).
  void frame(int u, int v, int side) {
    paint(u, v, u + side, v), paint(u, v + side, u + side, v + side);
    paint(u, v, u, v + side), paint(u + side, v, u + side, v + side);
  }
  void set(int u, int v, bool gate) {
    std::uint8_t* p = &bytes_[static_cast<std::size_t>(3 * (v * width_ + u))];
    p[0] = gate ? 140 : 110, p[1] = gate ? 100 : 128, p[2] = gate ? 145 : 128;
  }
  [[nodiscard]] Image image() const {
    return {bytes_.data(), PixelFormat::kYuv444, width_, height_};
  }

 private:
  int width_, height_;
  std::vector<std::uint8_t> bytes_;
};

Quad square(double u, double v, double side) {
  return {{{u, v}, {u + side, v}, {u + side, v + side}, {u, v + side}}};
}

PaperDetections paper(const PaperPicture& picture, const PaperDetectorParams& params = {},
                      std::uint64_t seed = 1) {
  Rng rng{seed};
  return detect_as_paper(picture.image(), params, rng);
}

std::optional<GateDetection> flown(const PaperPicture& picture,
                                   const FlownDetectorParams& params = {},
                                   const std::optional<Quad>& previous = std::nullopt) {
  Rng rng{1};
  return detect_as_flown(picture.image(), params, rng, previous);
}

void expect_corners(const Quad& found, const Quad& wanted) {
  for (std::size_t i = 0; i < 4; ++i) EXPECT_THAT(found[i], IsNear(wanted[i], 1e-12)) << i;
}

TEST(PaperDetector, FindsACleanGateAtItsCorners) {
  for_all(30, [](Rng& rng) {
    const int side = 30 + rng.uniform_index(40), u = rng.uniform_index(100 - side),
              v = rng.uniform_index(100 - side);
    PaperPicture picture(100, 100);
    picture.frame(u, v, side);
    const auto found = paper(picture);
    ASSERT_EQ(found.size(), 1u);
    expect_corners(found[0].corners_px, square(u, v, side));
    EXPECT_DOUBLE_EQ(found[0].fitness, 1.0);
  });
}

TEST(PaperDetector, MinimumLengthMustBeExceeded) {
  PaperPicture picture(60, 60);
  picture.frame(10, 12, 30);
  EXPECT_EQ(paper(picture, {.min_side_px = 29.9}).size(), 1u);
  EXPECT_EQ(paper(picture, {.min_side_px = 30.0}).size(), 0u);
}

TEST(PaperDetector, ColourFitnessMustBeExceeded) {
  PaperPicture picture(60, 60);
  picture.frame(10, 12, 30);
  picture.paint(20, 12, 30, 12, false);  // a hole in the upper bar, wider than the tolerance
  const auto all = paper(picture, {.min_color_fitness = 0.0});
  ASSERT_FALSE(all.empty());
  const double fitness = all[0].fitness;
  EXPECT_GT(fitness, 0.9);
  EXPECT_LT(fitness, 0.98);  // 11 px of 120 less 4 px of tolerance
  EXPECT_EQ(paper(picture, {.min_color_fitness = fitness}).size(), 0u);
  EXPECT_EQ(paper(picture, {.min_color_fitness = std::nextafter(fitness, 0.0)}).size(), 1u);
}

TEST(PaperDetector, EveryCandidateCountsButTheSameGateOnce) {
  PaperPicture picture(260, 100);
  picture.frame(10, 10, 40);
  picture.frame(90, 20, 60);
  EXPECT_EQ(paper(picture).size(), 2u);
  picture.paint(180, 20, 240, 80);  // filled: the ROC study has no inside test
  EXPECT_EQ(paper(picture).size(), 3u);
}

TEST(PaperDetector, SameGeneratorSameAnswer) {
  Rng noise{5};
  PaperPicture picture(120, 120);
  picture.frame(20, 20, 50);
  for (int i = 0; i < 3000; ++i)
    picture.set(noise.uniform_index(120), noise.uniform_index(120), true);
  const PaperDetectorParams params{.min_side_px = 5.0, .min_color_fitness = 0.0};
  const auto a = paper(picture, params, 9), b = paper(picture, params, 9);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) expect_corners(a[i].corners_px, b[i].corners_px);
}

TEST(FlownDetector, FindsACleanGateAtItsCorners) {
  PaperPicture picture(160, 100);
  picture.frame(40, 20, 50);
  const auto gate = flown(picture);
  ASSERT_TRUE(gate.has_value());
  expect_corners(gate->corners_px, square(40, 20, 50));
  EXPECT_DOUBLE_EQ(gate->fitness, 1.0);
}

TEST(FlownDetector, MinimumLengthMustBeExceeded) {
  PaperPicture picture(100, 100);
  picture.frame(20, 20, 30);
  EXPECT_FALSE(flown(picture, {.min_side_px = 30.0}).has_value());
  EXPECT_TRUE(flown(picture, {.min_side_px = 29.9}).has_value());
}

TEST(FlownDetector, AFilledSquareIsNoGate) {
  PaperPicture picture(100, 100);
  picture.paint(20, 20, 70, 70);
  EXPECT_FALSE(flown(picture).has_value());
}

TEST(FlownDetector, ThreeSidesAreNoGate) {
  PaperPicture picture(100, 100);
  picture.frame(20, 20, 50);
  picture.paint(22, 20, 68, 20, false);
  EXPECT_FALSE(flown(picture).has_value());
}

TEST(FlownDetector, TriesLastFramesCornersWhenThisOneGivesNone) {
  PaperPicture picture(100, 100);
  picture.frame(22, 19, 50);
  const FlownDetectorParams blind{.samples = 0};
  EXPECT_FALSE(flown(picture, blind).has_value());
  const auto gate = flown(picture, blind, square(20, 20, 48));
  ASSERT_TRUE(gate.has_value());
  expect_corners(gate->corners_px, square(22, 19, 50));
  EXPECT_FALSE(flown(PaperPicture(100, 100), blind, square(20, 20, 48)).has_value());
}

TEST(PaperAndFlownDetector, NastyPicturesGiveAnAnswerInBoundedTime) {
  Rng rng{1};
  EXPECT_TRUE(detect_as_paper(Image{}, {}, rng).empty());
  EXPECT_FALSE(detect_as_flown(Image{}, {}, rng, square(0, 0, 10)).has_value());

  std::vector<PaperPicture> pictures;
  for (const auto& [width, height] :
       {std::pair{1, 1}, {2, 2}, {1, 300}, {300, 1}, {315, 160}, {3150, 1600}}) {
    pictures.emplace_back(width, height);
    pictures.back().paint(0, 0, width - 1, height - 1);
  }
  PaperPicture checkerboard(315, 160), noise(315, 160);
  for (int v = 0; v < 160; ++v)
    for (int u = 0; u < 315; ++u)
      checkerboard.set(u, v, (u + v) % 2 == 0), noise.set(u, v, rng.uniform_index(2) == 0);
  pictures.push_back(checkerboard), pictures.push_back(noise);

  for (const PaperPicture& picture : pictures) {
    const PaperDetections found = paper(picture, {.min_side_px = 0.0, .min_color_fitness = 0.0});
    EXPECT_LE(found.size(), 1000u);
    for (const GateDetection& gate : found)
      for (const auto& corner : gate.corners_px) EXPECT_TRUE(corner.allFinite());
    (void)flown(picture, {}, square(-20, -20, 400));
  }
}

TEST(PaperDetector, AFullListEndsTheSearch) {
  PaperPicture crowd(1000, 1000);
  for (int v = 2; v < 990; v += 8)
    for (int u = 2; u < 990; u += 8) crowd.frame(u, v, 4);
  const auto found =
      paper(crowd, {.samples = 100'000, .min_side_px = 2.0, .min_color_fitness = 0.0});
  EXPECT_TRUE(found.full());
}

}  // namespace
}  // namespace gatefly
