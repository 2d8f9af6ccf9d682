// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/bar_pieces.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include <gtest/gtest.h>

namespace gatefly {
namespace {

constexpr int kStride = 8;

/// A piece of the bar x = c0 + c1 y + c2 y².
Bar piece(const Eigen::Vector3d& curve, double top, double bottom) {
  Bar bar{.top = top, .bottom = bottom, .strength = bottom - top, .width = 6.0};
  bar.curve = curve;
  // Its chord.
  bar.slope = curve[1] + curve[2] * (top + bottom);
  bar.at_0 = curve[0] - curve[2] * top * bottom;
  return bar;
}

const Eigen::Vector3d kBent{100.0, 0.3, -0.002}, kElsewhere{220.0, -0.1, 0.0};

TEST(BeyondABar, ItsCurveGoesStraightOn) {
  const Bar bar = piece(kBent, 40, 120);
  for (const double y : {40.0, 71.5, 120.0}) EXPECT_EQ(beyond(bar, y), bar.on_curve(y)) << y;
  for (const auto& [end, y] : {std::pair{40.0, -20.0}, {120.0, 180.0}}) {
    const double slope = kBent[1] + 2.0 * kBent[2] * end;
    EXPECT_NEAR(beyond(bar, y).x(), bar.on_curve(end).x() + slope * (y - end), 1e-9) << y;
    EXPECT_EQ(beyond(bar, y).y(), y);
  }
}

// Three pieces of one bar and another bar, in every order.
TEST(JoinPieces, MakesOneBarOfThoseThatContinueEachOther) {
  const std::array<Bar, 4> pieces{piece(kBent, 4, 44), piece(kBent, 60, 92), piece(kBent, 116, 156),
                                  piece(kElsewhere, 4, 156)};
  std::array<std::size_t, 4> order{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  do {
    BarFinder::Bars bars;
    for (const std::size_t i : order) bars.push_back(pieces[i]);
    join_pieces(bars, kStride);
    ASSERT_EQ(bars.size(), 2u);
    const Bar& joined = bars[bars[0].on_curve(80).x() > 180.0 ? 1 : 0];
    EXPECT_EQ(joined.top, 4.0);
    EXPECT_EQ(joined.bottom, 156.0);
    EXPECT_DOUBLE_EQ(joined.strength, 40.0 + 32.0 + 40.0);
    EXPECT_NEAR(joined.width, 6.0, 1e-9);
    for (double y = 4.0; y <= 156.0; y += 8.0)
      EXPECT_NEAR(joined.on_curve(y).x(), kBent[0] + kBent[1] * y + kBent[2] * y * y, 1e-6) << y;
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(JoinPieces, LeavesWhatIsFarApartBesideOrInTheOtherDirection) {
  const Eigen::Vector3d upright{100.0, 0.0, 0.0}, beside{115.0, 0.0, 0.0}, across{20.0, 1.0, 0.0};
  for (const auto& other : {piece(upright, 100, 150), piece(beside, 64, 150), piece(beside, 4, 60),
                            piece(across, 20, 120)}) {
    BarFinder::Bars bars;
    bars.push_back(piece(upright, 4, 60)), bars.push_back(other);
    join_pieces(bars, kStride);
    EXPECT_EQ(bars.size(), 2u) << other.top << ".." << other.bottom;
  }
}

TEST(JoinPieces, NoneAndOneStayAsTheyAre) {
  BarFinder::Bars bars;
  join_pieces(bars, kStride);
  EXPECT_TRUE(bars.empty());
  bars.push_back(piece(kBent, 4, 60));
  join_pieces(bars, kStride);
  ASSERT_EQ(bars.size(), 1u);
  EXPECT_EQ(bars[0].curve, kBent);
}

}  // namespace
}  // namespace gatefly
