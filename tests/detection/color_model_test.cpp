// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/color_model.hpp"

#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>

#include "support/orange.hpp"

namespace gatefly {
namespace {

using namespace test;

constexpr Yuv kPlainGrey{110, 128, 128};

TEST(ColorModel, ItsOwnColourSpeaksForIt) {
  const Yuv orange = yuv_of_rgb(255, 102, 0);
  EXPECT_GT(kOrange.evidence(orange, kPlainGrey), 2 * ColorModel::kUnit);
}

TEST(ColorModel, GreyAndTheOppositeHueSpeakAgainstIt) {
  for (int y = 0; y < 256; y += 15) {
    const auto luma = static_cast<std::uint8_t>(y);
    EXPECT_LT(kOrange.evidence({luma, 128, 128}, kPlainGrey), 0);
    EXPECT_LT(kOrange.evidence({luma, 190, 70}, kPlainGrey), -ColorModel::kUnit);
  }
}

// A wall of the gate's own colour: what does not differ from its surroundings says less.
TEST(ColorModel, TheSameColourSaysLessWhereAllIsOfThatColour) {
  const Yuv pale{140, 112, 146};
  EXPECT_GT(kOrange.evidence(pale, kPlainGrey),
            kOrange.evidence(pale, pale) + ColorModel::kUnit / 2);
}

// A washed-out gate: nearly grey, but a little more orange than the wall.
TEST(ColorModel, AFewLevelsTowardsTheHueAreEvidenceOfDifference) {
  const Yuv wall{150, 124, 124}, washed_out{170, 116, 133};
  EXPECT_GT(kOrange.relative[ColorModel::difference_bin(washed_out, wall)], 0);
}

TEST(ColorModel, MoreColourIsNeverLessEvidence) {
  int before = -1000;
  for (int chroma = 0; chroma <= 60; chroma += 4) {
    const Yuv c{120, static_cast<std::uint8_t>(128 - chroma * 3 / 4),
                static_cast<std::uint8_t>(128 + chroma * 2 / 3)};
    const int now = kOrange.evidence(c, kPlainGrey);
    EXPECT_GE(now, before) << "chroma " << chroma;
    before = now;
  }
}

TEST(ColorModel, EveryColourHasABin) {
  for (int a = 0; a < 256; a += 5)
    for (int b = 0; b < 256; b += 5) {
      const auto x = static_cast<std::uint8_t>(a), y = static_cast<std::uint8_t>(b);
      EXPECT_LT(ColorModel::bin({x, y, x}), ColorModel::kBins);
      EXPECT_LT(ColorModel::difference_bin({x, y, x}, {y, x, y}), ColorModel::kBins);
    }
}

// The tables' and the multiplication's answer in plain words.
std::size_t plain_bin(int value, int first, int levels, std::size_t count) {
  return static_cast<std::size_t>(
      std::clamp((value - first) / levels, 0, static_cast<int>(count) - 1));
}
std::size_t plain_index(std::size_t luma, std::size_t u, std::size_t v) {
  return (luma * ColorModel::kChroma + u) * ColorModel::kChroma + v;
}
std::uint8_t byte(int level) { return static_cast<std::uint8_t>(level); }

TEST(ColorModel, AChromaBinIsFourLevelsEachWay) {
  for (int u = 0; u < 256; ++u)
    for (int v = 0; v < 256; ++v)
      ASSERT_EQ(ColorModel::chroma_bin(PackedYuv::of({byte(u ^ v), byte(u), byte(v)})),
                static_cast<std::size_t>(v / 4 + 64 * (u / 4)))
          << u << ", " << v;
}

TEST(ColorModel, ABinIsSixteenLevelsOfLumaAndFourOfEachChromaFrom64On) {
  const auto chroma = [](int level) { return plain_bin(level, 64, 4, ColorModel::kChroma); };
  for (int y = 0; y < 256; ++y)
    for (int u = 0; u < 256; ++u) {
      const int v = (7 * u + y) % 256;
      ASSERT_EQ(ColorModel::bin({byte(y), byte(u), byte(v)}),
                plain_index(static_cast<std::size_t>(y / 16), chroma(u), chroma(v)))
          << y << ", " << u;
    }
}

TEST(ColorModel, ADifferencesBinIsTwelveLevelsOfLumaAndThreeOfEachChromaAroundZero) {
  const auto chroma = [](int step) { return plain_bin(step, -48, 3, ColorModel::kChroma); };
  for (int a = 0; a < 256; ++a)
    for (int b = 0; b < 256; ++b) {
      const Yuv c{byte(a), byte(b), byte(3 * a)}, around{byte(b), byte(a), byte(5 * b)};
      ASSERT_EQ(ColorModel::difference_bin(c, around),
                plain_index(plain_bin(a - b, -96, 12, ColorModel::kLuma), chroma(b - a),
                            chroma(c.v - around.v)))
          << a << ", " << b;
    }
}

// A passed-over chroma may not be a bar's with any luma; and most chromas of a hall are passed
// over.
TEST(ColorModel, AChromaIsHopelessIfItIsWithEveryLuma) {
  int hopeless = 0;
  for (int u = 0; u < 256; ++u)
    for (int v = 0; v < 256; ++v) {
      const auto of = [&](int y) {
        return Yuv{static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(u),
                   static_cast<std::uint8_t>(v)};
      };
      bool all = true;
      for (int y = 0; y < 256; ++y)
        all = all && kOrange.absolute[ColorModel::bin(of(y))] < ColorModel::kHopeless;
      const int said = kOrange.hopeless[ColorModel::chroma_bin(PackedYuv::of(of(7)))];
      ASSERT_EQ(said, all ? 1 : 0) << u << ", " << v;
      hopeless += said;
    }
  EXPECT_GT(hopeless, 256 * 256 / 2);
  EXPECT_LT(hopeless, 256 * 256);
}

}  // namespace
}  // namespace gatefly
