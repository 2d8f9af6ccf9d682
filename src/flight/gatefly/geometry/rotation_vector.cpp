// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/rotation_vector.hpp"

#include <cmath>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {

// Rodrigues: R = I + a [t] + b [t]², a = sin|t| / |t|, b = (1 - cos|t|) / |t|².
Eigen::Matrix3d rotation_of(const Eigen::Vector3d& turn) {
  constexpr double kSmall = 0.01;  // of |t|²; the series' next term is below 1e-14 there
  const double t2 = turn.squaredNorm();
  double a = 1.0 - t2 / 6.0 * (1.0 - t2 / 20.0 * (1.0 - t2 / 42.0));
  double b = 0.5 * (1.0 - t2 / 12.0 * (1.0 - t2 / 30.0 * (1.0 - t2 / 56.0)));
  if (!(t2 < kSmall)) {
    const double t = std::sqrt(t2);
    const auto [s, c] = sincos(t);
    a = s / t, b = (1.0 - c) / t2;
  }
  const Eigen::Matrix3d K = skew(turn);
  return Eigen::Matrix3d::Identity() + a * K + b * K * K;
}

Eigen::Vector3d turn_of(const Eigen::Matrix3d& R) {
  const Eigen::Vector3d axis =
      0.5 * Eigen::Vector3d{R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)};
  const double s = axis.norm(), c = 0.5 * (R.trace() - 1.0);
  if (s < 1e-9) return axis;
  return gatefly::atan2(s, c) / s * axis;
}

}  // namespace gatefly
