// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/snake_search.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/detection/search/bar_finder.hpp"

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/orange.hpp"
#include "support/views_of_a_gate.hpp"
#include "support/worst_corner.hpp"

namespace gatefly {
namespace {

using namespace test;

GateDetections gates_in(const Canvas& canvas) {
  static SnakeSearch search;
  const auto bytes = canvas.yuv444();
  return search.detect({bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()},
                       kOrange);
}

class SnakeSearchFrom : public ::testing::TestWithParam<Place> {};

// 20 views each, noisy wall: four of five are found, and the median of the worst corners is small.
TEST_P(SnakeSearchFrom, FindsTheOuterCorners) {
  const FoundCorners corners = found_corners(GetParam(), gates_in);
  ASSERT_GE(corners.views, 5);
  EXPECT_GE(corners.found(), corners.views - corners.views / 5);
  EXPECT_LT(corners.median(), 2.0);
}

INSTANTIATE_TEST_SUITE_P(Places, SnakeSearchFrom,
                         ::testing::Values(Place{2.0, 0}, Place{3.0, 0}, Place{4.0, 0},
                                           Place{2.5, 30}, Place{2.5, -45}, Place{2.5, 60}));

TEST(SnakeSearch, FollowsABarOverAHole) {
  const CameraRig rig = bebop_rig();
  const View view{{-2.0, 0, 0.1}, {}};
  Canvas canvas(315, 160);
  canvas.draw_gate(view, rig);
  const Quad truth = corners_of(1.0, view, rig).value();
  const int left = static_cast<int>(truth[0].x()),
            middle = static_cast<int>(0.5 * (truth[0].y() + truth[3].y()));
  canvas.blank(left - 6, left + 8, middle - 5, middle + 5);
  const auto gates = gates_in(canvas);
  ASSERT_EQ(gates.size(), 1u);
  EXPECT_LT(worst_corner(gates[0].corners_px, truth), 3.0);
}

TEST(SnakeSearch, TwoGatesAreTwo) {
  const CameraRig rig = bebop_rig();
  const View near{{-2.5, 0.8, 0}, {}}, far{{-3.5, -1.4, 0}, {}};
  Canvas canvas(315, 160);
  canvas.draw_gate(near, rig), canvas.draw_gate(far, rig);
  const auto gates = gates_in(canvas);
  ASSERT_EQ(gates.size(), 2u);
  for (const View& view : {near, far}) {
    const Quad truth = corners_of(1.0, view, rig).value();
    EXPECT_LT(std::min(worst_corner(gates[0].corners_px, truth),
                       worst_corner(gates[1].corners_px, truth)),
              3.0);
  }
}

TEST(SnakeSearch, TheSameSceneInAnySizeShowsTheSameGate) {
  const View view{{-3.0, 0.3, 0.2}, {0.1, -0.05, 0.1}};
  for (const int times : {1, 2, 3, 4}) {
    CameraRig rig = bebop_rig();
    rig.lens.model =
        DhaneFisheye{{168.0 * times, 168.0 * times}, {157.0 * times, 124.0 * times}, 1.08};
    Canvas canvas(315 * times, 160 * times);
    canvas.draw_gate(view, rig);
    const auto gates = gates_in(canvas);
    ASSERT_EQ(gates.size(), 1u) << times;
    EXPECT_LT(worst_corner(gates[0].corners_px, corners_of(1.0, view, rig).value()), 2.5 * times)
        << times;
  }
}

TEST(SnakeSearch, NoiseAndFilledSquaresAreNoGates) {
  for_all(30, [](Rng& rng) {
    Canvas canvas(315, 160);
    canvas.add_noise(rng, 60.0, 20.0);
    EXPECT_TRUE(gates_in(canvas).empty());
  });
  Canvas canvas(315, 160);
  canvas.draw_gate({{-3.0, 0, 0}, {}}, bebop_rig(), 1.0, 0.5);
  EXPECT_TRUE(gates_in(canvas).empty());
}

TEST(SnakeSearch, WhatWasLookedAtBeforeLeavesNoTrace) {
  Canvas canvas(315, 160), other(640, 480);
  Rng rng{3};
  canvas.draw_gate({{-3.0, 0.2, 0}, {}}, bebop_rig()), canvas.add_noise(rng),
      other.fill({120, 90, 190});
  const auto first = gates_in(canvas);
  (void)gates_in(other);
  const auto second = gates_in(canvas);
  ASSERT_EQ(first.size(), 1u);
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(worst_corner(first[0].corners_px, second[0].corners_px), 0.0);
}

/// A noisy picture of a gate, of any size, in which bars were looked for.
struct Searched {
  int width, height;
  std::vector<std::uint8_t> bytes;
  BarFinder finder{5, 1};

  explicit Searched(Rng& rng)
      : width{60 + static_cast<int>(rng.uniform(0, 300))},
        height{40 + static_cast<int>(rng.uniform(0, 200))} {
    Canvas canvas(width, height);
    canvas.draw_gate({{-2.5, 0, 0}, {}}, bebop_rig());
    canvas.add_noise(rng);
    bytes = canvas.yuv444();
    (void)finder.find(image(), kOrange);
  }
  [[nodiscard]] Image image() const { return {bytes.data(), PixelFormat::kYuv444, width, height}; }
  [[nodiscard]] BarFinder::Evidence evidence(int cell) const {
    static const PictureColor kColor{kOrange};
    return finder.evidence(image(), kColor, cell);
  }
};

// The faster way along a line says of every place what the place itself says, inside, outside and
// across the border.
TEST(BarEvidence, AlongALineIsThatOfItsPlaces) {
  for_all(20, [](Rng& rng) {
    const Searched picture{rng};
    const int width = picture.width, height = picture.height;
    const BarFinder::Evidence evidence = picture.evidence(1);
    for (int line = 0; line < 50; ++line) {
      const auto place = [&](int size) {
        return static_cast<std::int64_t>(65536 * rng.uniform(-20, size + 20));
      };
      const std::int64_t x = place(width), y = place(height), dx = (place(width) - x) / 40,
                         dy = (place(height) - y) / 40;
      evidence.along(x, y, dx, dy, 40, [&](int k, int said) {
        ASSERT_EQ(said, evidence(static_cast<int>((x + k * dx) >> 16),
                                 static_cast<int>((y + k * dy) >> 16)))
            << line << ", " << k;
      });
    }
  });
}

// Across a bar, too: what speaks for a bar at a place speaks for it there; what does not is nothing
// or less.
TEST(BarEvidence, AcrossIsThatOfItsPlaces) {
  for_all(20, [](Rng& rng) {
    const Searched picture{rng};
    const int width = picture.width, height = picture.height;
    for (const int cell : {1, 2}) {
      const BarFinder::Evidence evidence = picture.evidence(cell);
      for (int line = 0; line < 200; ++line) {
        const int x = static_cast<int>(rng.uniform(-5, width / cell + 5)),
                  y = static_cast<int>(rng.uniform(-5, height / cell + 5));
        for (const bool down : {false, true}) {
          evidence.across(x, y, down, 1, [&](int said) {
            ASSERT_EQ(std::max(0, said), std::max(0, evidence(x, y))) << x << ", " << y;
          });
          // Around places next to each other it is much the same.
          int k = 0, off = 0;
          evidence.across(x, y, down, 7, [&](int said) {
            off += std::abs(std::max(0, said) -
                            std::max(0, down ? evidence(x, y + k) : evidence(x + k, y))),
                ++k;
          });
          ASSERT_EQ(k, 7);
          ASSERT_LT(off, 7 * 16) << x << ", " << y;
        }
      }
    }
  });
}

}  // namespace
}  // namespace gatefly
