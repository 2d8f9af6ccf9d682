// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/gate_bars.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "gatefly/detection/color_mask.hpp"

namespace gatefly {
namespace {

constexpr int kMaxColumns = 1280;
using Histogram = std::array<double, kMaxColumns>;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

// Highest column whose distance from `other` is at least `gap`; -1 when there is none.
int highest(const Histogram& h, int size, int other, double gap) {
  int best = -1;
  for (int i = 0; i < size; ++i) {
    if (other >= 0 && std::abs(i - other) < gap) continue;
    if (best < 0 || h[index(i)] > h[index(best)]) best = i;
  }
  return best;
}

// The column must be a peak of its own, not the flank of the other one.
bool has_valley_between(const Histogram& h, int a, int b) {
  const double low = std::min(h[index(a)], h[index(b)]);
  for (int i = std::min(a, b); i <= std::max(a, b); ++i)
    if (h[index(i)] < 0.5 * low) return true;
  return false;
}

}  // namespace

std::optional<GateBars> detect_bars(const Image& image, const ColorRange& color,
                                    const GateBarsParams& params,
                                    const std::optional<Eigen::Vector2d>& nadir_px) {
  const ColorMask is_gate{image, color};
  const int columns = std::min(image.width(), kMaxColumns);
  if (columns < 3 || image.height() < 2) return std::nullopt;

  // Every second row of the Bebop's 160, as many of larger pictures: the cost grows with the side.
  const int row_step = std::max(2, image.height() / 80);
  // Where the line from straight down through a pixel cuts the middle row; -1 outside.
  const double middle = 0.5 * image.height();
  const auto column_of = [&](int u, int v) {
    if (!nadir_px || std::abs(nadir_px->y() - v) < 0.3 * image.height()) return u;
    const double scale = (nadir_px->y() - middle) / (nadir_px->y() - v);
    const double column = nadir_px->x() + (u - nadir_px->x()) * scale + 0.5;
    return column >= 0.0 && column < columns ? static_cast<int>(column) : -1;
  };
  Histogram count{}, sum_u{}, sum_v{};
  for (int v = 0; v < image.height(); v += row_step)
    for (int u = 0; u < columns; ++u)
      if (is_gate(u, v)) {
        const int column = column_of(u, v);
        if (column < 0) continue;
        count[index(column)] += 1.0;
        sum_u[index(column)] += u;
        sum_v[index(column)] += v;
      }

  Histogram smooth{};
  const int half = std::max(1, params.smoothing_px / 2);
  for (int u = 0; u < columns; ++u) {
    const int from = std::max(0, u - half), to = std::min(columns - 1, u + half - 1);
    for (int i = from; i <= to; ++i) smooth[index(u)] += count[index(i)];
    smooth[index(u)] /= 2.0 * half;
  }

  const int first = highest(smooth, columns, -1, 0);
  const int second = first < 0 ? -1 : highest(smooth, columns, first, params.min_gap_px);
  if (second < 0) return std::nullopt;
  const double rows = static_cast<double>(image.height()) / row_step;
  const double high = smooth[index(first)], low = smooth[index(second)];
  if (0.5 * (high + low) < params.min_height * rows || low < params.min_ratio * high ||
      !has_valley_between(smooth, first, second))
    return std::nullopt;

  const auto centroid = [&](int peak) {
    double n = 0, u_sum = 0, v_sum = 0;
    for (int u = std::max(0, peak - 2 * half); u <= std::min(columns - 1, peak + 2 * half); ++u) {
      n += count[index(u)];
      u_sum += sum_u[index(u)];
      v_sum += sum_v[index(u)];
    }
    return Eigen::Vector2d{u_sum / n, v_sum / n};
  };
  return GateBars{centroid(std::min(first, second)), centroid(std::max(first, second))};
}

}  // namespace gatefly
