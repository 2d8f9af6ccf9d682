// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/filled_frame.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "support/for_all.hpp"

namespace gatefly {
namespace {

using namespace test;

constexpr int kFilledWidth = 120, kFilledHeight = 120, kFrom = 30, kTo = 90;
constexpr double kFilledBar = 0.05;
constexpr Yuv kFilledGrey{110, 128, 128}, kFilledOrange{130, 90, 170};
const Quad kFrame{{{kFrom, kFrom}, {kTo, kFrom}, {kTo, kTo}, {kFrom, kTo}}};

using Paint = std::function<Yuv(int u, int v)>;

/// A frame with bars of three pixels on any background, its opening painted.
double lost(const Paint& inside, const Paint& outside, const Quad& frame = kFrame) {
  std::vector<std::uint8_t> bytes;
  for (int v = 0; v < kFilledHeight; ++v)
    for (int u = 0; u < kFilledWidth; ++u) {
      const auto within = [&](int margin) {
        return u >= kFrom - margin && u <= kTo + margin && v >= kFrom - margin && v <= kTo + margin;
      };
      const Yuv c = within(-2) ? inside(u, v) : within(1) ? kFilledOrange : outside(u, v);
      bytes.insert(bytes.end(), {c.y, c.u, c.v});
    }
  return lost_as_filled({bytes.data(), PixelFormat::kYuv444, kFilledWidth, kFilledHeight}, frame,
                        kFilledBar, {});
}

Paint plain(Yuv color) {
  return [color](int, int) { return color; };
}

TEST(FilledFrame, AnOpeningShowsWhatIsAroundIt) {
  EXPECT_EQ(lost(plain(kFilledGrey), plain(kFilledGrey)), 0.0);
}

// A floor, a wall, a window: on both sides of a bar the same, whatever it is.
TEST(FilledFrame, ABackgroundThatChangesFromSideToSideCostsNothing) {
  for_all(50, [](Rng& rng) {
    const auto colour = [&] {
      const auto level = [&] { return static_cast<std::uint8_t>(rng.uniform(100.0, 156.0)); };
      return Yuv{level(), level(), level()};
    };
    const Yuv left = colour(), right = colour();
    const int edge = static_cast<int>(rng.uniform(kFrom, kTo));
    const Paint background = [=](int u, int) { return u < edge ? left : right; };
    EXPECT_LT(lost(background, background), 0.1);
  });
}

TEST(FilledFrame, AScreenInAFrameOfItsOwnColourLosesMost) {
  constexpr Yuv kYellow{200, 80, 150};
  EXPECT_GT(lost(plain(kYellow), plain(kFilledGrey)), 1.0);
  EXPECT_EQ(lost(plain(kFilledGrey), plain(kYellow)), lost(plain(kYellow), plain(kFilledGrey)))
      << "a hole in something coloured is as little a gate";
}

// Grey on grey: a print on a plain wall is filled, a bright day behind the gate's whole surroundings
// is not.
TEST(FilledFrame, APrintOnAPlainWallIsFilledATexturedWallBehindAGateIsNot) {
  Rng rng{5};
  std::array<std::uint8_t, 225> patches;
  for (std::uint8_t& y : patches) y = static_cast<std::uint8_t>(rng.uniform(40.0, 200.0));
  const Paint patched = [&](int u, int v) {
    return Yuv{patches[static_cast<std::size_t>(v / 8 * 15 + u / 8)], 128, 128};
  };
  EXPECT_GT(lost(patched, plain(kFilledGrey)), 1.0);
  EXPECT_EQ(lost(patched, patched), 0.0);
}

TEST(FilledFrame, AStepOfLumaAloneCostsNoMoreThanItsLimit) {
  EXPECT_NEAR(lost(plain({250, 128, 128}), plain({20, 128, 128})), 1.5, 1e-9);
}

TEST(FilledFrame, WhatThePictureDoesNotShowIsNotAsked) {
  Quad outside = kFrame;
  for (Eigen::Vector2d& corner : outside) corner.x() += kFilledWidth;
  EXPECT_EQ(lost(plain(kFilledOrange), plain(kFilledGrey), outside), 0.0);
}

}  // namespace
}  // namespace gatefly
