// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gatefly::flight_log {

/// Squared errors in units of their covariance, which ought to be chi-square distributed.
struct ChiSquareCount {
  int samples = 0;
  double sum_per_dof = 0.0;  ///< Sum of chi-square / degrees of freedom; mean 1 is ideal.
  int inside = 0;            ///< In the middle 95 % of the distribution.

  /// dof 1 to 8; others are not counted.
  void add(double chi2, int dof);
};

}  // namespace gatefly::flight_log
