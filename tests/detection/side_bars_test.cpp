// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/paper/side_bars.hpp"

#include <cstdint>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/detection/gate_detector.hpp"

namespace gatefly {
namespace {

constexpr int kBarsWidth = 315, kBarsHeight = 160;

/// Upright bars in the flown colour on grey.
struct BarPicture {
  BarPicture() : bytes(std::size_t{3} * kBarsWidth * kBarsHeight) {
    for (std::size_t i = 0; i < bytes.size(); i += 3)
      bytes[i] = 110, bytes[i + 1] = 128, bytes[i + 2] = 128;
  }
  void bar(int u0, int u1, int v0 = 0, int v1 = kBarsHeight - 1) {
    for (int v = v0; v <= v1; ++v)
      for (int u = u0; u <= u1; ++u) {
        const auto i = static_cast<std::size_t>(3 * (v * kBarsWidth + u));
        bytes[i] = 140, bytes[i + 1] = 100, bytes[i + 2] = 150;
      }
  }
  [[nodiscard]] Image image() const {
    return {bytes.data(), PixelFormat::kYuv444, kBarsWidth, kBarsHeight};
  }
  [[nodiscard]] std::optional<GateBars> bars(std::uint64_t seed = 1) const {
    Rng rng{seed};
    return side_bars_by_histogram(image(), {}, rng);
  }
  std::vector<std::uint8_t> bytes;
};

TEST(SideBars, TheTwoHighestColumnsAreTheBarsLeftAndRight) {
  BarPicture picture;
  picture.bar(40, 49, 20, 159), picture.bar(250, 259);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto bars = picture.bars(seed);
    ASSERT_TRUE(bars) << seed;
    EXPECT_NEAR(bars->left_px.x(), 44.5, 2.0);
    EXPECT_NEAR(bars->right_px.x(), 254.5, 2.0);
    EXPECT_NEAR(bars->left_px.y(), 89.5, 10.0) << "the middle of what is in view";
    EXPECT_NEAR(bars->right_px.y(), 79.5, 10.0);
  }
}

TEST(SideBars, OneBarIsNoGate) {
  BarPicture picture;
  EXPECT_FALSE(picture.bars()) << "grey";
  picture.bar(40, 49);
  EXPECT_FALSE(picture.bars());
}

TEST(SideBars, ABarLessThanHalfAsHighAsTheOtherIsNone) {
  BarPicture picture;
  picture.bar(40, 49), picture.bar(250, 259, 0, 60);
  EXPECT_FALSE(picture.bars());
  picture.bar(250, 259, 0, 110);
  EXPECT_TRUE(picture.bars());
}

// Nine hits of the 31.7 that a column coloured from top to bottom has.
TEST(SideBars, ShortBarsAreNone) {
  BarPicture picture;
  picture.bar(40, 49, 60, 90), picture.bar(250, 259, 60, 90);
  EXPECT_FALSE(picture.bars());
}

TEST(SideBars, AreWhatBothPaperModesFindOfANearGate) {
  BarPicture picture;
  picture.bar(30, 41), picture.bar(270, 281);
  for (const auto mode : {DetectorMode::kPaper, DetectorMode::kFlown}) {
    GateDetector detector{{}, mode};
    const auto part = detector
                          .look(picture.image(), ColorModel::described({1.0, 0.4, 0.0}),
                                {.gates = LookFor::Gates::kNone, .part = LookFor::Part::kToo})
                          .part;
    ASSERT_TRUE(part);
    EXPECT_FALSE(part->gate.whole);
    EXPECT_FALSE(part->lower_corners());
    EXPECT_NEAR(part->bars.left_px.x(), 35.5, 4.0) << "anywhere on a bar wider than the smoothing";
  }
}

TEST(SideBars, AnEmptyPictureHasNone) {
  Rng rng;
  EXPECT_FALSE(side_bars_by_histogram(Image{}, {}, rng));
}

}  // namespace
}  // namespace gatefly
