// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/frame_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

using Eigen::Vector2d;

constexpr std::array kSizes{7.5, 11.0, 19.3};

Vector2d of(const CellStep& step) { return {step.x, step.y}; }

/// Calls visit(frame, turned, size, turn in degrees) for every frame.
template <class Visit>
void each_frame(const FrameLattice& lattice, double first_turn, const Visit& visit) {
  for (std::size_t i = 0; i < lattice.sizes().size(); ++i) {
    double turn = first_turn;
    for (const FrameLattice::Turned& turned : lattice.sizes()[i].turns) {
      for (std::size_t k = 0; k < turned.count; ++k)
        visit(lattice.frame(turned.first + k), turned, kSizes[i], turn);
      turn += 10.0;
    }
  }
}

TEST(FrameLattice, TriesEveryTurnUpToTheLargestInStepsOfTen) {
  for (const auto& [most, turns] : {std::pair{0.0, 1u},
                                    {9.9, 1u},
                                    {10.0, 3u},
                                    {60.0, 13u},
                                    {65.0, 13u},
                                    {180.0, 37u},
                                    {1000.0, 37u},
                                    {-5.0, 1u}}) {
    const FrameLattice lattice{kSizes, most, FrameLattice::kShapes};
    ASSERT_EQ(lattice.sizes().size(), kSizes.size());
    for (const FrameLattice::Size& size : lattice.sizes())
      EXPECT_EQ(size.turns.size(), turns) << most;
  }
}

TEST(FrameLattice, UprightSidesHaveTheToldLengthAndTurn) {
  const FrameLattice lattice{kSizes, 180.0, FrameLattice::kShapes};
  each_frame(lattice, -180.0, [](const auto& frame, const auto&, double size, double turn) {
    const Vector2d down = frame.down.template cast<double>();
    const double angle = turn * kPi / 180.0;
    EXPECT_NEAR(down.norm(), size, 1e-5);
    EXPECT_NEAR((down - size * Vector2d{-std::sin(angle), std::cos(angle)}).norm(), 0.0, 1e-5);
  });
}

// Face to face a square, else as wide as it looks from the side; never a mirror image.
TEST(FrameLattice, FramesAreSquaresFromTheSide) {
  const FrameLattice lattice{kSizes, 60.0, FrameLattice::kShapes};
  for (const FrameLattice::Size& size : lattice.sizes())
    for (const FrameLattice::Turned& turned : size.turns) {
      double before = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < turned.count; ++k) {
        const FrameLattice::Frame& f = lattice.frame(turned.first + k);
        const Vector2d across = f.across.cast<double>(), down = f.down.cast<double>();
        const double width = (across.x() * down.y() - across.y() * down.x()) / down.squaredNorm();
        EXPECT_GT(width, 0.3);
        EXPECT_LE(width, before + 1e-6) << "narrower and narrower";
        before = width;
        if (k > 0) continue;
        EXPECT_NEAR(width, 1.0, 1e-5);
        EXPECT_NEAR(across.dot(down), 0.0, 1e-3);
      }
    }
}

// Rounding moves a step by half a cell; a number that does not fit would be far off.
TEST(FrameLattice, StepsAreWhatTheSidesSayToHalfACell) {
  const FrameLattice lattice{kSizes, 180.0, FrameLattice::kShapes};
  const auto near = [](const CellStep& step, const Vector2d& is) {
    return (of(step) - is).cwiseAbs().maxCoeff() < 0.5001;
  };
  const auto are_on = [&](const FrameLattice::Side& side, const Vector2d& d) {
    for (std::size_t k = 0; k < side.samples.size(); ++k) {
      const Vector2d is = ((static_cast<double>(k) + 0.5) / FrameLattice::kSamples - 0.5) * d;
      EXPECT_TRUE(near(side.samples[k], is)) << k;
      EXPECT_LE(std::abs(side.samples[k].x), side.reach.x);
      EXPECT_LE(std::abs(side.samples[k].y), side.reach.y);
    }
  };
  each_frame(lattice, 0.0, [&](const auto& f, const auto& turned, double, double) {
    const Vector2d across = f.across.template cast<double>(), down = f.down.template cast<double>();
    are_on(f.level, across), are_on(turned.upright, down);
    EXPECT_TRUE(near(f.left, -0.5 * across) && near(f.right, across));
    EXPECT_TRUE(near(f.upper, -0.5 * down) && near(f.lower, down));
    EXPECT_TRUE(near(f.right_too, across + across.normalized()));
    EXPECT_TRUE(near(f.lower_too, down + down.normalized()));
    EXPECT_TRUE(near(f.in_a, 0.2 * (across + down)) && near(f.in_b, 0.2 * (across - down)));
  });
}

TEST(FrameLattice, NumbersFollowEachOtherAndASizesFitAByte) {
  for (const std::size_t shapes : {std::size_t{1}, std::size_t{3}, FrameLattice::kShapes}) {
    const FrameLattice lattice{kSizes, 180.0, shapes};
    std::size_t next = 0;
    for (const FrameLattice::Size& size : lattice.sizes()) {
      EXPECT_EQ(FrameLattice::first_of(size), next);
      for (const FrameLattice::Turned& turned : size.turns) {
        EXPECT_EQ(turned.first, next);
        EXPECT_EQ(turned.count, shapes);
        next += shapes;
      }
      EXPECT_LT(next - FrameLattice::first_of(size), 255u) << "0 is none";
    }
  }
}

TEST(CellStep, CountsRowsOfAPicture) {
  EXPECT_EQ((CellStep{3, 0}.in(100)), 3);
  EXPECT_EQ((CellStep{-3, 2}.in(100)), 197);
  EXPECT_EQ((CellStep{127, -128}.in(1000)), -127'873);
}

}  // namespace
}  // namespace gatefly
