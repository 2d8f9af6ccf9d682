// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/pose_starts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::reprojection {
namespace {

using Points = std::array<const Sight*, 4>;

/// ∂m/∂(y, z) at the middle of four points, and m there.
struct Slope {
  Eigen::Matrix2d J;
  Eigen::Vector2d m;
};

std::optional<Slope> homography_slope(const Points& points, const Eigen::Vector3d& middle_G) {
  // m = (h₁ᵀw, h₂ᵀw) / h₃ᵀw with w = (y, z, 1) from the middle, h₃ = (·, ·, 1).
  Eigen::Matrix<double, 8, 8> M = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> b;
  for (int i = 0; i < 4; ++i) {
    const Sight& sight = *points[static_cast<std::size_t>(i)];
    const Eigen::Vector2d w = (sight.point_G - middle_G).tail<2>();
    M.block<1, 3>(2 * i, 0) = w.homogeneous().transpose();
    M.block<1, 3>(2 * i + 1, 3) = w.homogeneous().transpose();
    M.block<2, 2>(2 * i, 6) = -sight.m * w.transpose();
    b.segment<2>(2 * i) = sight.m;
  }
  const Eigen::Matrix<double, 8, 1> h = M.partialPivLu().solve(b);
  Slope slope;
  slope.m = {h(2), h(5)};
  slope.J << h(0), h(1), h(3), h(4);
  slope.J -= slope.m * h.tail<2>().transpose();
  if (!slope.J.allFinite() || !slope.m.allFinite()) return std::nullopt;
  return slope;
}

double larger_singular_value(const Eigen::Matrix2d& J) {
  const double a = (J.row(0) + Eigen::RowVector2d{J(1, 1), -J(1, 0)}).norm();
  const double b = (J.row(0) - Eigen::RowVector2d{J(1, 1), -J(1, 0)}).norm();
  return 0.5 * (a + b);
}

}  // namespace

std::optional<Pose> start_from_rays(const Sights& sights, Active active, const PosePrior& prior,
                                    const CameraRig& rig) {
  constexpr double kNominalMiss = 0.02;  // of a line of sight, to weigh the height against it [m]
  constexpr double kLeastSpread = 1e-9;
  const Eigen::Matrix3d R_GB = rotation_EB(prior.attitude_GB).matrix;
  const Eigen::Matrix3d R_GC = R_GB * rig.R_BC.matrix;
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if ((active >> i & 1u) == 0) continue;
    const Eigen::Vector3d v = R_GC * sights[i].m.homogeneous().normalized();
    Eigen::Matrix3d N = Eigen::Matrix3d::Identity() - v * v.transpose();  // Eq. (8)
    if (sights[i].line) {
      const Eigen::Vector3d n = v.cross(sights[i].along_G).normalized();
      N = n * n.transpose();
    }
    A += N;
    b += N * sights[i].point_G;
  }
  const double weight = std::min(1.0, std::pow(kNominalMiss / prior.z_sigma, 2));
  const Eigen::Vector3d lever_arm_G = R_GB * rig.p_BC;
  A(2, 2) += weight;
  b.z() += weight * (prior.z + lever_arm_G.z());
  Eigen::Matrix3d A_inverse;
  bool solvable = false;
  A.computeInverseWithCheck(A_inverse, solvable, kLeastSpread);
  if (!solvable || !A_inverse.allFinite()) return std::nullopt;
  return Pose{R_GB.transpose() * (A_inverse * b) - rig.p_BC,
              {prior.attitude_GB.roll, prior.attitude_GB.pitch, prior.attitude_GB.yaw}};  // Eq. (9)
}

FixedList<Pose, 2> starts_from_homography(const Sights& sights, Active active,
                                          const CameraRig& rig) {
  FixedList<Pose, 2> starts;
  Points points{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < sights.size() && count < 4; ++i)
    if ((active >> i & 1u) != 0 && !sights[i].line && sights[i].point_G.x() == 0.0)
      points[count++] = &sights[i];
  if (count < 4) return starts;
  const Eigen::Vector3d middle_G =
      0.25 * (points[0]->point_G + points[1]->point_G + points[2]->point_G + points[3]->point_G);
  const auto slope = homography_slope(points, middle_G);
  if (!slope) return starts;

  // A camera C' that looks at the middle: b, and two directions across it.
  const double length = slope->m.homogeneous().norm();
  Eigen::Matrix3d R_CK;
  R_CK.col(2) = slope->m.homogeneous() / length;
  R_CK.col(0) = R_CK.col(2).unitOrthogonal();
  R_CK.col(1) = R_CK.col(2).cross(R_CK.col(0));
  const Eigen::Matrix2d J = R_CK.topLeftCorner<2, 2>().transpose() * slope->J / length;
  const double inverse_distance = larger_singular_value(J);
  if (!(inverse_distance > 1e-6)) return starts;
  const Eigen::Matrix2d S = J / inverse_distance;
  const Eigen::Matrix2d cc = Eigen::Matrix2d::Identity() - S.transpose() * S;
  Eigen::Vector2d c{std::sqrt(std::max(0.0, cc(0, 0))), std::sqrt(std::max(0.0, cc(1, 1)))};
  if (cc(0, 1) < 0.0) c.y() = -c.y();

  for (const double sign : {1.0, -1.0}) {
    Eigen::Matrix3d R_KG;
    R_KG.col(1) << S.col(0), sign * c.x();
    R_KG.col(2) << S.col(1), sign * c.y();
    R_KG.col(0) = R_KG.col(1).cross(R_KG.col(2));
    if (!(R_KG(2, 0) > 0.0)) continue;  // seen from behind
    const Eigen::Matrix3d R_GC = (R_CK * R_KG).transpose();
    const Eigen::Matrix3d R_GB = R_GC * rig.R_BC.matrix.transpose();
    const Attitude attitude = attitude_of({R_GB});
    const Eigen::Vector3d camera_G = middle_G - R_GC * R_CK.col(2) / inverse_distance;
    starts.push_back(
        {R_GB.transpose() * camera_G - rig.p_BC, {attitude.roll, attitude.pitch, attitude.yaw}});
  }
  return starts;
}

}  // namespace gatefly::reprojection
