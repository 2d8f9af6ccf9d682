// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/unknown_bend.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/for_all.hpp"

namespace gatefly::refinement {
namespace {

using namespace test;
using Eigen::Vector2d;

constexpr int kWidth = 640, kHeight = 360;
constexpr double kStrong = 2.3 / (1.0 * kWidth * kWidth);  // 1/px²

const std::vector<std::uint8_t> kBytes(std::size_t{3} * kWidth * kHeight);
const Image kImage{kBytes.data(), PixelFormat::kYuv444, kWidth, kHeight};

/// A square as a barrel shows it, and what crossings along its sides say.
struct BentSquare {
  BentSquare(const Vector2d& middle, double side, double roll, double k) {
    const auto bent = [k](const Vector2d& p) {
      const Vector2d center{0.5 * (kWidth - 1), 0.5 * (kHeight - 1)}, m = p - center;
      return Vector2d{center + (1.0 - k * m.squaredNorm()) * m};
    };
    Quad square{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    for (Vector2d& p : square)
      p = middle + 0.5 * side *
                       Vector2d{std::cos(roll) * p.x() - std::sin(roll) * p.y(),
                                std::sin(roll) * p.x() + std::cos(roll) * p.y()};
    for (std::size_t i = 0; i < 4; ++i) corners[i] = bent(square[i]);
    for (std::size_t i = 0; i < 4; ++i) {
      for (int j = 0; j < kCrossings; ++j) {
        const double t = (j + 0.5) / kCrossings;
        crossings[i].push_back(bent((1.0 - t) * square[i] + t * square[(i + 1) % 4]));
      }
      fit(i);
    }
  }

  // Least squares: the best line, and what is left of y² and of x beside lines.
  void fit(std::size_t i) {
    Side& side = sides[i] = Side{corners[i], corners[(i + 1) % 4]};
    Eigen::Matrix<double, kCrossings, 2> A;
    Eigen::Matrix<double, kCrossings, 1> x, square;
    for (int j = 0; j < kCrossings; ++j) {
      const Vector2d& p = crossings[i][static_cast<std::size_t>(j)];
      const double y = side.along(p);
      A(j, 0) = 1.0, A(j, 1) = y, x[j] = side.across(p), square[j] = y * y;
    }
    const auto solver = (A.transpose() * A).inverse() * A.transpose();
    const Vector2d line = solver * x, part = solver * square;
    side.at_0 = line[0], side.slope = line[1];
    const auto left = square - A * part;
    curvatures[i] = {.moment = left.dot(x - A * line),
                     .weight = left.squaredNorm(),
                     .part = part[0],
                     .y_part = part[1]};
  }
  /// How far the crossing that is farthest from its side is.
  [[nodiscard]] double farthest() const {
    double most = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
      for (const Vector2d& p : crossings[i])
        most = std::max(most, std::abs(sides[i].x(sides[i].along(p)) - sides[i].across(p)));
    return most;
  }

  static constexpr int kCrossings = 32;
  Quad corners;
  std::array<std::vector<Vector2d>, 4> crossings;
  std::array<Side, 4> sides;
  std::array<Curvature, 4> curvatures;
};

BentSquare any_square(Rng& rng, double k) {
  return {{rng.uniform(260, 380), rng.uniform(150, 210)},
          rng.uniform(200, 260),
          rng.uniform(-0.5, 0.5),
          k};
}

TEST(UnknownBend, OfABarrelIsRecoveredFromItsSides) {
  for_all(50, [](Rng& rng) {
    const double k = rng.uniform(0.2, 0.6) * kStrong;
    BentSquare square = any_square(rng, k);
    const double before = square.farthest();
    UnknownBend bend{kImage, square.corners};
    EXPECT_TRUE(bend.shows());
    bend.adapt(square.corners, square.curvatures, 1.0, square.sides);
    EXPECT_LT(square.farthest(), 0.35 * before);
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector2d a = square.corners[i], b = square.corners[(i + 1) % 4],
                     normal = Vector2d{b.y() - a.y(), a.x() - b.x()}.normalized();
      const auto& on_side = square.crossings[i];
      const Vector2d middle = 0.5 * (on_side[15] + on_side[16]);
      EXPECT_NEAR(bend.sag(a, b).dot(normal), (middle - a).dot(normal), 0.5 + 0.15 * before) << i;
    }
  });
}

TEST(UnknownBend, IsNoneOnStraightSidesAndNeverTheOtherWay) {
  for_all(50, [](Rng& rng) {
    for (const double k : {0.0, -0.3 * kStrong}) {
      BentSquare square = any_square(rng, k);
      UnknownBend bend{kImage, square.corners};
      bend.adapt(square.corners, square.curvatures, 1.0, square.sides);
      EXPECT_LT(bend.sag(square.corners[0], square.corners[1]).norm(), 1e-6);
      for (const Side& side : square.sides) EXPECT_LT(std::abs(side.curve), 1e-9);
    }
  });
}

TEST(UnknownBend, IsNeverMuchStrongerThanAWideLens) {
  BentSquare square{{320, 180}, 240, 0.1, 0.0};
  for (Curvature& c : square.curvatures) c.moment = 0.0;
  UnknownBend bend{kImage, square.corners};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d outwards = 0.5 * (square.corners[i] + square.corners[(i + 1) % 4]) -
                              Vector2d{0.5 * (kWidth - 1), 0.5 * (kHeight - 1)};
    const Side& side = square.sides[i];
    square.curvatures[i].moment =
        (side.across(outwards) > 0.0 ? -1.0 : 1.0) * square.curvatures[i].weight;
  }
  bend.adapt(square.corners, square.curvatures, 1.0, square.sides);
  // half a chord, squared, times how far its middle is from the picture's
  const double most = 1.5 * kStrong * 120.0 * 120.0 * 120.0;
  EXPECT_NEAR(bend.sag(square.corners[0], square.corners[1]).norm(), most, 0.02 * most);
}

// Few crossings are weak evidence for what is improbable; no crossing is none.
TEST(UnknownBend, IsBelievedTheMoreTheMoreCrossingsSaySo) {
  double before = 0.0;
  for (const double part : {0.0, 0.001, 0.01, 1.0}) {
    BentSquare square{{320, 180}, 240, 0.1, 0.5 * kStrong};
    for (Curvature& c : square.curvatures) c.moment *= part, c.weight *= part;
    UnknownBend bend{kImage, square.corners};
    bend.adapt(square.corners, square.curvatures, 1.0, square.sides);
    const double sag = bend.sag(square.corners[0], square.corners[1]).norm();
    if (part == 0.0)
      EXPECT_EQ(sag, 0.0);
    else
      EXPECT_GT(sag, before) << part;
    before = sag;
  }
}

TEST(UnknownBend, ShowsOnALargeFrameOnly) {
  EXPECT_TRUE((UnknownBend{kImage, BentSquare{{320, 180}, 240, 0.0, 0.0}.corners}.shows()));
  EXPECT_FALSE((UnknownBend{kImage, BentSquare{{320, 180}, 40, 0.0, 0.0}.corners}.shows()));
}

}  // namespace
}  // namespace gatefly::refinement
