// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gmock/gmock.h>

namespace gatefly::test {

/// Every coefficient within `tolerance` of `expected`'s.
MATCHER_P2(IsNear, expected, tolerance, "") {
  const auto off = (Eigen::MatrixXd(arg) - Eigen::MatrixXd(expected)).cwiseAbs().maxCoeff();
  *result_listener << "\n"
                   << Eigen::MatrixXd(arg) << "\nis off by " << off << " from\n"
                   << Eigen::MatrixXd(expected);
  return off <= tolerance;  // false for NaN
}

/// Orthonormal with determinant +1.
MATCHER(IsRotation, "is a rotation matrix") {
  const Eigen::Matrix3d R = arg;
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  *result_listener << "R R^T is off by " << off << ", det = " << R.determinant();
  return off < 1e-12 && R.determinant() > 0.0;
}

/// Finite, symmetric, positive definite.
MATCHER(IsCovariance, "is a covariance") {
  const Eigen::MatrixXd P = arg;
  if (!P.allFinite()) return false;
  const double skewed = (P - P.transpose()).cwiseAbs().maxCoeff();
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(P).eigenvalues().minCoeff();
  *result_listener << "asymmetry " << skewed << ", least eigenvalue " << least;
  return skewed <= 1e-12 * (1.0 + P.cwiseAbs().maxCoeff()) && least > 0.0;
}

}  // namespace gatefly::test
