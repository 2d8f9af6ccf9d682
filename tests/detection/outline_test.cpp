// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/outline.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;

// A frame of 4 px bars whose centre line runs from (40, 30) to (120, 110), upright.
struct Frame {
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(200 * 150 * 3, 128);
  Quad line{{{40, 30}, {120, 30}, {120, 110}, {40, 110}}};
  Frame() {
    for (int v = 28; v <= 112; ++v)
      for (int u = 38; u <= 122; ++u)
        if (u <= 42 || u >= 118 || v <= 32 || v >= 108) paint(u, v);
  }
  void paint(int u, int v) {
    std::uint8_t* p = &bytes[static_cast<std::size_t>(3 * (v * 200 + u))];
    p[0] = 120, p[1] = 90, p[2] = 190;
  }
  void erase(int u, int v) {
    std::uint8_t* p = &bytes[static_cast<std::size_t>(3 * (v * 200 + u))];
    p[0] = p[1] = p[2] = 128;
  }
  [[nodiscard]] ColorMask mask() const { return {Image{bytes.data(), PixelFormat::kYuv444, 200, 150}, ColorRange{}}; }
};

Quad moved(const Quad& q, double u, double v) {
  Quad out;
  for (std::size_t i = 0; i < 4; ++i) out[i] = q[i] + Vector2d{u, v};
  return out;
}

TEST(ColorMask, NothingIsColouredOutsideThePicture) {
  const Frame frame;
  EXPECT_TRUE(frame.mask()(40, 30));
  EXPECT_FALSE(frame.mask()(-1, 30));
  EXPECT_FALSE(frame.mask()(200, 30));
  EXPECT_FALSE(frame.mask()(40, 1'000'000));
  EXPECT_TRUE(frame.mask().near(37, 30)) << "one pixel beside the bar";
  EXPECT_FALSE(frame.mask().near(36, 30));
}

TEST(OutlineFitness, IsOneOnAPerfectFrameAndZeroBesideIt) {
  const Frame frame;
  const OutlineFitness on = outline_fitness(frame.mask(), frame.line);
  EXPECT_DOUBLE_EQ(on.all, 1.0);
  for (const double side : on.side) EXPECT_DOUBLE_EQ(side, 1.0);
  EXPECT_LT(outline_fitness(frame.mask(), scaled(frame.line, 0.7)).all, 0.05);
  EXPECT_DOUBLE_EQ(outline_fitness(frame.mask(), moved(frame.line, 500, 0)).all, 0.0) << "outside the picture";
}

TEST(OutlineFitness, NamesTheSideThatIsMissing) {
  Frame frame;
  for (int v = 33; v < 108; ++v)
    for (int u = 118; u <= 122; ++u) frame.erase(u, v);
  const OutlineFitness fitness = outline_fitness(frame.mask(), frame.line);
  EXPECT_LT(fitness.side[1], 0.15) << "the right one";
  EXPECT_GT(fitness.side[0], 0.99);
  EXPECT_GT(fitness.side[2], 0.99);
  EXPECT_GT(fitness.side[3], 0.99);
}

TEST(OutlineFitness, OfAPointIsFinite) {
  const Frame frame;
  const Quad point{{{40, 30}, {40, 30}, {40, 30}, {40, 30}}};
  EXPECT_DOUBLE_EQ(outline_fitness(frame.mask(), point).all, 1.0);
}

TEST(InsideFraction, TellsAFrameFromAPoster) {
  Frame frame;
  EXPECT_DOUBLE_EQ(inside_fraction(frame.mask(), frame.line), 0.0);
  for (int v = 33; v < 108; ++v)
    for (int u = 43; u < 118; ++u) frame.paint(u, v);
  EXPECT_DOUBLE_EQ(inside_fraction(frame.mask(), frame.line), 1.0);
}

TEST(CornersByLines, AreTheCentreLinesCorners) {
  const Frame frame;
  const Quad found = corners_by_lines(frame.mask(), moved(frame.line, 1, -1));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_THAT(found[i], IsNear(frame.line[i], 0.3));
}

TEST(CornersByLines, KeepACornerWhoseBarIsGone) {
  Frame frame;
  for (int v = 60; v < 113; ++v)
    for (int u = 38; u < 100; ++u) frame.erase(u, v);  // around bottom-left
  const Quad found = corners_by_lines(frame.mask(), frame.line);
  EXPECT_EQ(found[3], frame.line[3]);
  EXPECT_THAT(found[1], IsNear(frame.line[1], 0.3));
}

TEST(Scaled, GrowsAboutTheMiddle) {
  const Frame frame;
  const Quad big = scaled(frame.line, 1.5);
  EXPECT_THAT(center(big), IsNear(center(frame.line), 1e-12));
  EXPECT_NEAR(area(big), 2.25 * area(frame.line), 1e-9);
}

}  // namespace
}  // namespace gatefly
