// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/pose_moments.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/exponential.hpp"

namespace gatefly::reprojection {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Vector6 state_of(const Pose& pose) {
  Vector6 x;
  x << turned(pose.angles).R_GB * pose.p_GB_B, pose.angles;
  return x;
}

/// Weighted sums of what lies off the fit.
struct Sums {
  double weight = 1.0;  ///< The fit's own.
  Vector6 first = Vector6::Zero();
  Matrix6 second = Matrix6::Zero();

  void add(double w, const Vector6& off) {
    weight += w;
    first += w * off;
    second += w * off * off.transpose();
  }
};

}  // namespace

std::optional<Moments> moments_of(const Fit& fit) {
  const Normal& n = fit.normal;
  bool solvable = false, positive = false;
  Eigen::Matrix3d A_inverse, P_angles;
  n.A.computeInverseWithCheck(A_inverse, solvable, 1e-12 * n.A.trace() * n.A.trace() * n.A.trace());
  if (!solvable) return std::nullopt;
  const Eigen::Matrix3d gain = A_inverse * n.B;
  (n.C - n.B.transpose() * gain).computeInverseWithCheck(P_angles, positive, 0.0);
  if (!positive) return std::nullopt;
  // p_GB = R_GB p_GB_B
  const Turned body = turned(fit.pose.angles);
  const Eigen::Matrix3d slope = -body.R_GB * (gain + skew(fit.pose.p_GB_B) * body.axes_B);
  Moments moments;
  moments.mean << body.R_GB * fit.pose.p_GB_B, fit.pose.angles;
  Matrix6& P = moments.covariance;
  P.topLeftCorner<3, 3>() =
      body.R_GB * A_inverse * body.R_GB.transpose() + slope * P_angles * slope.transpose();
  P.topRightCorner<3, 3>() = slope * P_angles;
  P.bottomLeftCorner<3, 3>() = P.topRightCorner<3, 3>().transpose();
  P.bottomRightCorner<3, 3>() = P_angles;
  P = (0.5 * (P + P.transpose())).eval();
  return P.allFinite() && P.diagonal().minCoeff() > 0.0 ? std::optional{moments} : std::nullopt;
}

Moments integrated_moments_of(const Fit& fit, const Moments& by_curvature, const Sights& sights,
                              Active active, const PosePrior& prior, const CameraRig& rig) {
  constexpr int kFarthest = 4;  // steps
  // sigmas; the sum over a normal density is then 0.6 % off its variance
  constexpr double kStep = 1.5;
  const Eigen::Matrix3d A_inverse = fit.normal.A.inverse();
  const Eigen::Matrix3d P_angles = by_curvature.covariance.bottomRightCorner<3, 3>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spectrum{P_angles};  // ascending
  const Eigen::Matrix3d sigmas =
      spectrum.eigenvectors() * spectrum.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();

  Sums sums;
  for (int i = -kFarthest; i <= kFarthest; ++i)
    for (int j = -kFarthest; j <= kFarthest; ++j) {
      if ((i == 0 && j == 0) || i * i + j * j > kFarthest * kFarthest + 1) continue;
      const Eigen::Vector3d turn = kStep * (i * sigmas.col(1) + j * sigmas.col(2));
      Pose pose{fit.pose.p_GB_B - A_inverse * (fit.normal.B * turn), fit.pose.angles + turn};
      const auto normal = normal_at(pose, sights, active, prior, rig);
      if (!normal) continue;
      // The position that is best there, in one step.
      const Eigen::Vector3d step = normal->A.inverse() * normal->a;
      const double weight =
          gatefly::exp(0.5 * (fit.normal.cost - normal->cost + normal->a.dot(step)));
      if (!(weight > 1e-4 && weight < 1e4)) continue;
      pose.p_GB_B -= step;
      sums.add(weight, state_of(pose) - by_curvature.mean);
    }

  // Around each: the position's own covariance, and the third direction, as the curvature tells.
  const Vector6 off = sums.first / sums.weight;
  Moments moments{by_curvature.mean + off, sums.second / sums.weight - off * off.transpose()};
  const Turned body = turned(fit.pose.angles);
  Eigen::Matrix<double, 6, 3> slope;
  slope << -body.R_GB * (A_inverse * fit.normal.B + skew(fit.pose.p_GB_B) * body.axes_B),
      Eigen::Matrix3d::Identity();
  moments.covariance += slope * sigmas.col(0) * sigmas.col(0).transpose() * slope.transpose();
  moments.covariance.topLeftCorner<3, 3>() += body.R_GB * A_inverse * body.R_GB.transpose();
  return moments.covariance.allFinite() ? moments : by_curvature;
}

}  // namespace gatefly::reprojection
