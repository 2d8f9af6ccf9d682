// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/chi_square_count.hpp"

#include <array>
#include <cstddef>

namespace gatefly::flight_log {

void ChiSquareCount::add(double chi2, int dof) {
  // 2.5 and 97.5 %
  constexpr std::array<double, 8> kLow{0.000982, 0.0506, 0.2158, 0.4844,
                                       0.8312,   1.2373, 1.6899, 2.1797};
  constexpr std::array<double, 8> kHigh{5.024,  7.378,  9.348,  11.143,
                                        12.833, 14.449, 16.013, 17.535};
  if (dof < 1 || dof > 8) return;
  const auto i = static_cast<std::size_t>(dof - 1);
  ++samples;
  sum_per_dof += chi2 / dof;
  inside += chi2 >= kLow[i] && chi2 <= kHigh[i];
}

}  // namespace gatefly::flight_log
