// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/picture_color.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/orange.hpp"

namespace gatefly {
namespace {

using namespace test;

constexpr int kMostGain = 10;

/// A picture of a hall: coloured patches of a few pixels.
struct Hall {
  int width = 160, height = 120;
  std::vector<std::uint8_t> bytes;

  Hall(Rng& rng, double contrast, int cast_u = 0, int cast_v = 0) {
    const auto level = [](double x) {
      return static_cast<std::uint8_t>(std::clamp(x, 0.0, 255.0));
    };
    bytes.resize(static_cast<std::size_t>(3 * width * height));
    for (int v = 0; v < height; v += 4)
      for (int u = 0; u < width; u += 4) {
        const double y = rng.uniform(60, 180), along = contrast * rng.uniform(-20, 20);
        for (int j = v; j < v + 4; ++j)
          for (int i = u; i < u + 4; ++i) {
            std::uint8_t* const to = bytes.data() + 3 * (j * width + i);
            to[0] = level(y), to[1] = level(128 + cast_u - 0.7 * along),
            to[2] = level(128 + cast_v + 0.7 * along);
          }
      }
  }
  [[nodiscard]] Image image() const { return {bytes.data(), PixelFormat::kYuv444, width, height}; }
};

TEST(ChromaTone, OfAnEmptyPictureIsThatOfAny) {
  EXPECT_EQ(tone_of({}, kOrange), ChromaTone{});
  const std::vector<std::uint8_t> pixel{100, 100, 160};
  const ChromaTone tone = tone_of({pixel.data(), PixelFormat::kYuv444, 1, 1}, kOrange);
  EXPECT_EQ(tone, ChromaTone{});  // no pair to compare
}

TEST(ChromaTone, TheLessContrastTheMoreGainAndNeverLessThanOne) {
  Rng rng{1};
  int before = -1;
  for (const double contrast : {4.0, 1.0, 0.5, 0.25, 0.12, 0.0}) {
    const ChromaTone tone = tone_of(Hall{rng, contrast}.image(), kOrange);
    EXPECT_GE(tone.gain, before) << contrast;
    before = tone.gain;
  }
  EXPECT_EQ(tone_of(Hall{rng, 4.0}.image(), kOrange).gain, 0);
  EXPECT_EQ(before, kMostGain);
}

TEST(ChromaTone, ASmallCastIsTheRoomsALargeOneTheLights) {
  Rng rng{2};
  const ChromaTone small = tone_of(Hall{rng, 1.0, 4, -4}.image(), kOrange);
  EXPECT_EQ(small.neutral_u, 128);
  EXPECT_EQ(small.neutral_v, 128);
  const ChromaTone large = tone_of(Hall{rng, 1.0, 24, -20}.image(), kOrange);
  EXPECT_NEAR(large.neutral_u, 128 + 24 - 5, 3);
  EXPECT_NEAR(large.neutral_v, 128 - 20 + 5, 3);
}

TEST(PictureColor, WithoutAToneIsTheModel) {
  const PictureColor color{kOrange};
  for_all(200, [&](Rng& rng) {
    const auto byte = [&] { return static_cast<std::uint8_t>(rng.uniform(0, 255.99)); };
    const Yuv c{byte(), byte(), byte()}, around{byte(), byte(), byte()};
    ASSERT_EQ(color.evidence(c, around), kOrange.evidence(c, around));
    ASSERT_EQ(color.is_hopeless(PackedYuv::of(c)),
              kOrange.hopeless[ColorModel::chroma_bin(PackedYuv::of(c))] != 0);
  });
}

// Half the contrast with twice the gain says the same.
TEST(PictureColor, AFaintColourCountsAsTheFullOne) {
  PictureColor color;
  color.set(kOrange, {.gain = 4});  // an octave
  for (int k = -20; k <= 20; ++k) {
    const auto at = [](int chroma) { return static_cast<std::uint8_t>(chroma); };
    const Yuv faint{100, at(128 - k), at(128 + k)}, full{100, at(128 - 2 * k), at(128 + 2 * k)},
        grey{100, 128, 128};
    EXPECT_EQ(color.evidence(faint, grey), kOrange.evidence(full, grey)) << k;
  }
  EXPECT_GT(color.faintness(), 0.0);
  color.set(kOrange, {});
  EXPECT_EQ(color.faintness(), 0.0);
}

TEST(PictureColor, UnderAnotherLightTheSameColourIsAnother) {
  PictureColor color;
  color.set(kOrange, {.neutral_u = 140, .neutral_v = 118});
  const Yuv seen{100, 122, 142}, meant{100, 110, 152}, around{100, 140, 118}, grey{100, 128, 128};
  EXPECT_EQ(color.evidence(seen, around), kOrange.evidence(meant, grey));
}

}  // namespace
}  // namespace gatefly
