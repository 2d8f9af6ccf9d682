// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "gatefly/detection/color_model.hpp"
#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/gate_search_params.hpp"
#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Finds gates that stand out, in microseconds: Li18's snakes (Algorithm 1), in strides.
///
/// Every eighth row is read, every second pixel of it. A bar crosses several rows: a snake follows it from
/// row to row, one may be missing. Two bars of like slope and height are the sides of a frame; its level
/// bars are looked for between them, then all four sides are fitted. What differs from the paper: no random
/// samples, evidence in place of a colour box, upright bars first at any roll up to 60 deg (one pair of a
/// frame's sides is always within 45 deg of upright).
class SnakeSearch {
 public:
  explicit SnakeSearch(const GateSearchParams& params = {});

  /// Distinct gates, best first. Allocates nothing; the cost hardly depends on the picture's size.
  [[nodiscard]] GateDetections detect(const Image& image, const ColorModel& color);

 private:
  /// An upright bar: a line x = at_0 + slope y between two rows [px].
  struct Bar {
    double at_0 = 0.0, slope = 0.0, top = 0.0, bottom = 0.0, strength = 0.0;
    [[nodiscard]] double x(double y) const { return at_0 + slope * y; }
    [[nodiscard]] Eigen::Vector2d at(double y) const { return {x(y), y}; }
  };
  struct Snake;
  struct Pair;
  using Bars = FixedList<Bar, 24>;
  using Pairs = FixedList<Pair, 3>;

  void read(const Image& image, const ColorModel& color);
  void average_around();
  [[nodiscard]] Bars follow_bars(const Image& image, const ColorModel& color) const;
  template <class Visit>
  void each_crossing(const Image& image, const ColorModel& color, int row, const Visit& visit) const;
  [[nodiscard]] Bar bar_of(const Snake& snake) const;
  [[nodiscard]] Pairs pairs_of(const Bars& bars) const;
  [[nodiscard]] int evidence(const Image& image, const ColorModel& color, int u, int v) const;

  [[nodiscard]] Yuv around(int group) const {
    const auto i = static_cast<std::size_t>(group);
    return {around_[0][i], around_[1][i], around_[2][i]};
  }
  [[nodiscard]] int first_column() const { return step_ / 2; }
  [[nodiscard]] int row_px(int row) const { return row * stride_ + stride_ / 2; }

  GateSearchParams params_;
  int step_ = 0, stride_ = 0;                       // pixels from sample to sample, from row to row
  int rows_ = 0, groups_ = 0;                       // read of the picture; four samples of a row make a group
  std::uint32_t per_stride_ = 0;                    // 2^16 / stride_
  std::vector<std::int8_t> absolute_;               // evidence of each sample's colour alone
  std::array<std::vector<std::uint16_t>, 3> sums_;  // of each group's y, u, v; one group more on each side
  std::array<std::vector<std::uint8_t>, 3> around_;  // mean of three by three groups
};

}  // namespace gatefly
