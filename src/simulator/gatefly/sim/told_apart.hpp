// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace gatefly::sim {

/// Fields of one detection that a pilot can read without knowing where it is: fitness, side [px],
/// aspect, middle across, middle down [px], rank in the list.
inline constexpr std::array<const char*, 6> kFields{"fitness", "side", "aspect",
                                                    "across",  "down", "rank"};
using Fields = std::array<double, kFields.size()>;

[[nodiscard]] inline Fields fields_of(const std::array<Eigen::Vector2d, 4>& corners_px,
                                      double fitness, std::size_t rank) {
  const Eigen::Vector2d a = corners_px[2] - corners_px[0], b = corners_px[3] - corners_px[1],
                        middle =
                            0.25 * (corners_px[0] + corners_px[1] + corners_px[2] + corners_px[3]),
                        right = corners_px[1] - corners_px[0] + corners_px[2] - corners_px[3],
                        down = corners_px[3] - corners_px[0] + corners_px[2] - corners_px[1];
  return {fitness,
          std::sqrt(0.5 * std::abs(a.x() * b.y() - a.y() * b.x())),
          right.norm() / std::max(1e-9, down.norm()),
          middle.x(),
          middle.y(),
          static_cast<double>(rank)};
}

/// How well the best threshold on one number tells two kinds apart: the greatest difference
/// between the parts of both that lie below (Youden's index, Kolmogorov's distance). 0: not at all,
/// 1: always; 0 when one of them is empty.
[[nodiscard]] inline double told_apart(std::vector<double> a, std::vector<double> b) {
  if (a.empty() || b.empty()) return 0.0;
  std::sort(a.begin(), a.end()), std::sort(b.begin(), b.end());
  double greatest = 0.0;
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    const double x = std::min(a[i], b[j]);
    while (i < a.size() && a[i] == x) ++i;
    while (j < b.size() && b[j] == x) ++j;
    greatest = std::max(greatest, std::abs(static_cast<double>(i) / static_cast<double>(a.size()) -
                                           static_cast<double>(j) / static_cast<double>(b.size())));
  }
  return greatest;
}

}  // namespace gatefly::sim
