// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace gatefly::test {

/// Jacobian of `f` at `x`, numerically: column j is (f(x + h e_j) - f(x - h e_j)) / 2h.
template <class Function, int N>
auto central_difference(Function&& f, const Eigen::Matrix<double, N, 1>& x, double h = 1e-5) {
  using Value = decltype(f(x));
  Eigen::Matrix<double, Value::RowsAtCompileTime, N> J;
  for (int j = 0; j < N; ++j) {
    Eigen::Matrix<double, N, 1> high = x, low = x;
    high(j) += h, low(j) -= h;
    J.col(j) = (f(high) - f(low)) / (2.0 * h);
  }
  return J;
}

}  // namespace gatefly::test
