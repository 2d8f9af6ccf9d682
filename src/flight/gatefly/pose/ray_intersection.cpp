// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/ray_intersection.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace gatefly {

std::optional<Eigen::Vector3d> nearest_point(std::span<const Ray> rays, double min_spread) {
  if (rays.size() < 2) return std::nullopt;

  // Eq. (8): D(t; p, v)² = (t − p)ᵀ N (t − p) with N = I − v vᵀ.
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const auto& [p, v] : rays) {
    const Eigen::Matrix3d N = Eigen::Matrix3d::Identity() - v * v.transpose();
    A += N;
    b += N * p;
  }

  // λ_min(A) / n is the rays' mean sin² to their common direction: 0 when parallel.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spectrum{A, Eigen::EigenvaluesOnly};
  const double spread = spectrum.eigenvalues().minCoeff() / static_cast<double>(rays.size());
  if (!(spread >= min_spread)) return std::nullopt;  // also when NaN

  // Eq. (9): ∂/∂t Σ D² = 0  ⇔  A t = b.
  const Eigen::Vector3d t = A.ldlt().solve(b);
  for (const auto& [p, v] : rays)
    if (!(v.dot(p - t) > 0.0)) return std::nullopt;  // also when NaN
  return t;
}

}  // namespace gatefly
