// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/frame.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "support/for_all.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;

constexpr double kLeast = 10.0, kMostAspect = 3.2;

bool has_shape(const Quad& quad) { return is_frame_shaped(quad, kLeast, kMostAspect); }

Quad rectangle(double width, double height, double roll = 0.0) {
  Quad quad{{{0, 0}, {width, 0}, {width, height}, {0, height}}};
  for (Vector2d& p : quad)
    p = {std::cos(roll) * p.x() - std::sin(roll) * p.y(),
         std::sin(roll) * p.x() + std::cos(roll) * p.y()};
  return quad;
}

TEST(FrameShape, ASquareFromTheSideAtAnyTurnIsOne) {
  for_all(100, [](Rng& rng) {
    const double height = rng.uniform(35.0, 300.0), width = height / rng.uniform(1.0, 3.1);
    EXPECT_TRUE(has_shape(rectangle(width, height, rng.uniform(-3.2, 3.2))));
  });
}

TEST(FrameShape, NoneIsSmallerOrNarrowerThanTold) {
  EXPECT_TRUE(has_shape(rectangle(10.1, 10.1)));
  EXPECT_FALSE(has_shape(rectangle(9.9, 10.1)));
  EXPECT_TRUE(has_shape(rectangle(31.0, 99.0)));
  EXPECT_FALSE(has_shape(rectangle(31.0, 99.5)));
}

TEST(FrameShape, OppositeSidesAreAlike) {
  const auto trapezoid = [](double top) {
    return Quad{{{50 - top / 2, 0}, {50 + top / 2, 0}, {100, 100}, {0, 100}}};
  };
  EXPECT_TRUE(has_shape(trapezoid(60.0)));
  EXPECT_FALSE(has_shape(trapezoid(50.0)));
}

TEST(FrameShape, CrossedFlatOrTurnedRoundIsNone) {
  const Quad square = rectangle(50.0, 50.0);
  EXPECT_FALSE(has_shape({square[0], square[3], square[2], square[1]})) << "counter-clockwise";
  EXPECT_FALSE(has_shape({square[0], square[2], square[1], square[3]})) << "crossed";
  EXPECT_FALSE(has_shape({square[0], square[1], Vector2d{20, 20}, square[3]})) << "not convex";
  EXPECT_FALSE(has_shape({square[0], square[0], square[2], square[3]})) << "a triangle";
  Quad sheared = square;
  for (const std::size_t k : {2u, 3u}) sheared[k].x() += 150.0;
  EXPECT_FALSE(has_shape(sheared)) << "angles of 18 degrees";
  Quad broken = square;
  broken[2].x() = std::nan("");
  EXPECT_FALSE(has_shape(broken));
}

TEST(FrameScore, WhatIsTakenOffIsRemembered) {
  FrameScore score{.total = 3.0};
  score.take_off(1.0), score.take_off(0.5);
  EXPECT_DOUBLE_EQ(score.total, 1.5);
  EXPECT_DOUBLE_EQ(score.filled, 1.5);
}

/// A frame of 100 px in a picture of 200 px: bars worth 2, 1, 0.5 and -1 nats from the top on.
struct FrameScene {
  [[nodiscard]] GateDetection detected() const {
    return detection_of(frame, scaled(frame.quad, 1.05), DetectionMethod::kFrames, image);
  }
  Frame frame{.quad = {{{50, 50}, {150, 50}, {150, 150}, {50, 150}}},
              .score = {.total = 3.0, .side = {2.0, 1.0, 0.5, -1.0}}};
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(std::size_t{3} * 200 * 200);
  Image image{bytes.data(), PixelFormat::kYuv444, 200, 200};
};

TEST(FrameDetection, ACornerIsAsSureAsTheWeakerOfItsSides) {
  const FrameScene scene;
  const GateDetection gate = scene.detected();
  EXPECT_TRUE(gate.whole);
  EXPECT_EQ(gate.corners_px, scaled(scene.frame.quad, 1.05));
  EXPECT_DOUBLE_EQ(gate.fitness, confidence_of(3.0));
  const std::array<double, 4> weaker{-1.0, 1.0, 0.5, -1.0};
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_DOUBLE_EQ(gate.corner_fitness[k], corner_confidence_of(weaker[k])) << k;
  EXPECT_GT(corner_confidence_of(1.0), corner_confidence_of(0.5));
}

TEST(FrameDetection, IsTheSameWhicheverCornerComesFirst) {
  const FrameScene scene;
  const GateDetection should = scene.detected();
  for (std::size_t turn = 1; turn < 4; ++turn) {
    FrameScene turned;
    for (std::size_t k = 0; k < 4; ++k) {
      turned.frame.quad[k] = scene.frame.quad[(k + turn) % 4];
      turned.frame.score.side[k] = scene.frame.score.side[(k + turn) % 4];
    }
    const GateDetection gate = turned.detected();
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_LT((gate.corners_px[k] - should.corners_px[k]).norm(), 1e-9) << turn;
      EXPECT_EQ(gate.corner_fitness[k], should.corner_fitness[k]) << turn;
    }
  }
}

TEST(FrameDetection, WhatTheBorderHidesOrNobodySawHasNoFitness) {
  FrameScene cut, unseen;
  cut.frame.quad[1].x() = 199.0, cut.frame.quad[2].x() = 198.0;
  unseen.frame.unseen[3] = true;
  const GateDetection at_border = cut.detected(), rough = unseen.detected();
  EXPECT_FALSE(at_border.whole);
  EXPECT_EQ(at_border.corner_fitness[1], 0.0);
  EXPECT_GT(at_border.corner_fitness[2], 0.0) << "the last pixel but one";
  EXPECT_FALSE(rough.whole);
  EXPECT_EQ(rough.corner_fitness[3], 0.0);
  EXPECT_GT(rough.corner_fitness[0], 0.0);
}

}  // namespace
}  // namespace gatefly
