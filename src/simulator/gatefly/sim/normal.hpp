// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace gatefly::sim {

/// Part of standard normal numbers below x.
[[nodiscard]] inline double normal_cdf(double x) {
  return 0.5 * std::erfc(-x * 0.7071067811865476);
}

/// The standard normal number below which this part of them lies; by halving, to 1e-12. Within ±8.
[[nodiscard]] inline double normal_quantile(double part) {
  double low = -8.0, high = 8.0;
  for (int i = 0; i < 44; ++i) {
    const double middle = 0.5 * (low + high);
    (normal_cdf(middle) < part ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace gatefly::sim
