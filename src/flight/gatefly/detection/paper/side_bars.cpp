// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/paper/side_bars.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "gatefly/detection/paper/color_mask.hpp"

namespace gatefly {
namespace {

constexpr int kWidestPicture = 4096;  // no camera of ours is wider [px]

/// Hits by column, and the rows they were on.
struct Histogram {
  std::array<int, kWidestPicture> hits{};
  std::array<double, kWidestPicture> rows{};  ///< Summed.
  int width = 0;

  /// Mean over `count` columns around `u`; columns outside the picture hold nothing.
  [[nodiscard]] double smooth(int u, int count) const {
    int sum = 0;
    for (int i = u - count / 2; i < u - count / 2 + count; ++i)
      if (i >= 0 && i < width) sum += hits[static_cast<std::size_t>(i)];
    return static_cast<double>(sum) / count;
  }
  /// Mean place of the hits around `u`: across, down.
  [[nodiscard]] Eigen::Vector2d middle(int u, int count) const {
    double across = 0.0, down = 0.0;
    int sum = 0;
    for (int i = std::max(0, u - count / 2); i < std::min(width, u - count / 2 + count); ++i) {
      const auto k = static_cast<std::size_t>(i);
      sum += hits[k], across += static_cast<double>(i) * hits[k], down += rows[k];
    }
    return Eigen::Vector2d{across, down} / std::max(1, sum);
  }
};

struct Peak {
  int u = 0;
  double height = 0.0;
};

/// The highest column of those in [from, to).
Peak highest(const Histogram& histogram, int smoothing, int from, int to) {
  Peak peak{from, 0.0};
  for (int u = from; u < to; ++u)
    if (const double here = histogram.smooth(u, smoothing); here > peak.height) peak = {u, here};
  return peak;
}

/// The highest column, and the highest one beyond where it has fallen to half: random samples give
/// one bar several peaks.
std::pair<Peak, Peak> two_bars(const Histogram& histogram, int smoothing) {
  const Peak first = highest(histogram, smoothing, 0, histogram.width);
  const auto is_bar = [&](int u) {
    return u >= 0 && u < histogram.width && histogram.smooth(u, smoothing) > 0.5 * first.height;
  };
  int left = first.u, right = first.u;
  // At most once a column each.
  while (is_bar(left)) --left;
  while (is_bar(right)) ++right;
  const Peak before = highest(histogram, smoothing, 0, left + 1),
             behind = highest(histogram, smoothing, right, histogram.width);
  return {first, before.height > behind.height ? before : behind};
}

}  // namespace

std::optional<GateBars> side_bars_by_histogram(const Image& image, const SideBarsParams& params,
                                               Rng& rng) {
  if (image.empty() || image.width() > kWidestPicture) return std::nullopt;
  Histogram histogram;
  histogram.width = image.width();
  const ColorMask is_gate{image, params.color};
  for (int sample = 0; sample < params.samples; ++sample) {
    const int u = rng.uniform_index(image.width()), v = rng.uniform_index(image.height());
    if (!is_gate(u, v)) continue;
    ++histogram.hits[static_cast<std::size_t>(u)];
    histogram.rows[static_cast<std::size_t>(u)] += v;
  }
  const auto [high, low] = two_bars(histogram, params.smoothing);
  const double full = static_cast<double>(params.samples) / image.width();
  if (0.5 * (high.height + low.height) <= params.min_height * full ||
      low.height < params.min_ratio * high.height)
    return std::nullopt;
  Eigen::Vector2d left = histogram.middle(high.u, params.smoothing),
                  right = histogram.middle(low.u, params.smoothing);
  if (left.x() > right.x()) left.swap(right);
  return GateBars{left, right};
}

}  // namespace gatefly
