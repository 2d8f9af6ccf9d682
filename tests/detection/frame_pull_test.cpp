// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/frame_pull.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/for_all.hpp"
#include "support/worst_corner.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;

/// Evidence of a frame of straight bars, as wide as told, and of nothing else.
struct Bars {
  Quad middles;
  double half_width;

  int operator()(int x, int y) const {
    double nearest = 1e9;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector2d a = middles[k], d = middles[(k + 1) % 4] - a, p = Vector2d{x, y} - a;
      const double t = std::clamp(p.dot(d) / d.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (p - t * d).norm());
    }
    const double part = std::clamp(half_width + 0.5 - nearest, 0.0, 1.0);
    return static_cast<int>(std::lround(-16 + 48 * part));
  }
};

Quad any_frame(Rng& rng, double side) {
  const double roll = rng.uniform(-0.5, 0.5), c = std::cos(roll), s = std::sin(roll),
               width = rng.uniform(0.6, 1.0);
  Quad quad{{{-width, -1}, {width, -1}, {width, 1}, {-width, 1}}};
  for (Vector2d& p : quad)
    p = Vector2d{100, 80} + 0.5 * side * Vector2d{c * p.x() - s * p.y(), s * p.x() + c * p.y()};
  return quad;
}

Quad pulled_off(Quad quad, Rng& rng, double off) {
  for (Vector2d& p : quad) p += Vector2d{rng.uniform(-off, off), rng.uniform(-off, off)};
  return quad;
}

constexpr double kPullLeast = 5.0, kPullMostAspect = 3.2;

TEST(Pulled, AFrameAFewCellsOffEndsOnTheBars) {
  for_all(60, [](Rng& rng) {
    const double side = rng.uniform(15.0, 70.0);
    const Bars bars{any_frame(rng, side), std::max(0.8, 0.026 * side)};
    const FrameFit fit{bars};
    const Quad start = pulled_off(bars.middles, rng, 0.06 * side);
    const Frame frame = pulled(fit, Frame{start, fit.score(start)}, kPullLeast, kPullMostAspect);
    EXPECT_LT(worst_corner(frame.quad, bars.middles), 1.6 + 0.01 * side) << side;
    EXPECT_NEAR(frame.score.total, fit.score(frame.quad).total, 1e-12) << "its own score";
  });
}

// From anywhere, on bars or beside: it moves only when that helps.
TEST(Pulled, NeverScoresLessThanBefore) {
  for_all(200, [](Rng& rng) {
    const Bars bars{any_frame(rng, rng.uniform(10.0, 90.0)), rng.uniform(0.5, 3.0)};
    const FrameFit fit{bars};
    const Quad start = pulled_off(any_frame(rng, rng.uniform(10.0, 90.0)), rng, 8.0);
    const Frame before{start, fit.score(start)},
        after = pulled(fit, before, kPullLeast, kPullMostAspect);
    EXPECT_GE(after.score.total, before.score.total);
    EXPECT_TRUE(after.quad == start || is_frame_shaped(after.quad, kPullLeast, kPullMostAspect));
  });
}

TEST(Pulled, StaysWhereThereIsNothing) {
  const auto nothing = [](int, int) { return -16; };
  const FrameFit fit{nothing};
  Rng rng{1};
  const Quad start = any_frame(rng, 40.0);
  EXPECT_EQ(pulled(fit, Frame{start, fit.score(start)}, kPullLeast, kPullMostAspect).quad, start);
}

/// How far the corners of `quad` are from the lines of `sides`, at most.
double worst_side(const Quad& sides, const Quad& quad) {
  double worst = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d d = (sides[(i + 1) % 4] - sides[i]).normalized();
    for (const Vector2d& corner : {quad[i], quad[(i + 1) % 4]}) {
      const Vector2d to = corner - sides[i];
      worst = std::max(worst, std::abs(d.x() * to.y() - d.y() * to.x()));
    }
  }
  return worst;
}

// The middle of a bar in a row of whole pixels is off by half a pixel at most, and so is a line
// through such middles.
TEST(Finished, SidesLieWithinHalfAPixelOfTheMiddlesOfTheBars) {
  for_all(60, [](Rng& rng) {
    const GateDetectorParams params;
    const double side = rng.uniform(30.0, 120.0);
    const Bars bars{any_frame(rng, side), std::max(1.0, 0.5 * params.bar() * side)};
    FrameFit fit{bars, params.weights, params.bar()};
    fit.set_least_offset(3.0);
    const Quad start = pulled_off(bars.middles, rng, 2.0);
    const Frame frame = finished(fit, start, params.min_side_px, params);
    EXPECT_LT(worst_side(frame.quad, bars.middles), 0.5) << side;
    EXPECT_GT(frame.score.total, fit.score(start).total - 0.3);
  });
}

TEST(Finished, NeverScoresMuchLessThanBefore) {
  for_all(200, [](Rng& rng) {
    const GateDetectorParams params;
    const Bars bars{any_frame(rng, rng.uniform(10.0, 90.0)), rng.uniform(0.5, 3.0)};
    const FrameFit fit{bars};
    const Quad start = pulled_off(any_frame(rng, rng.uniform(10.0, 90.0)), rng, 8.0);
    EXPECT_GT(finished(fit, start, kPullLeast, params).score.total, fit.score(start).total - 0.3);
  });
}

}  // namespace
}  // namespace gatefly
