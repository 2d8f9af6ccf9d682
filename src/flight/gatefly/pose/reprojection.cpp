// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/reprojection.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::reprojection {
namespace {

constexpr double kLeastDepth = 0.02;  // nearer than that in front of the lens is not seen [m]

/// How far along `along` from `point` it comes nearest to the line of sight from the origin; 0 if
/// they are parallel.
double nearest_along(const Eigen::Vector3d& point, const Eigen::Vector3d& along,
                     const Eigen::Vector3d& sight) {
  const Eigen::Vector3d across = sight.cross(along).cross(sight);
  const double slope = across.dot(along);
  return slope > 1e-9 * sight.squaredNorm() * along.squaredNorm() ? -across.dot(point) / slope
                                                                  : 0.0;
}

/// Adds one residual r with ∂r/∂p = -k and ∂r/∂θ = l, θ being a small turn about the body's axes.
void add(Normal& n, double r, const Eigen::Vector3d& k, const Eigen::Vector3d& l) {
  n.A += k * k.transpose();
  n.B -= k * l.transpose();
  n.C += l * l.transpose();
  n.a -= k * r;
  n.c += l * r;
  n.cost += r * r;
}

void add_attitude_prior(Normal& n, const Eigen::Vector3d& angles, const PosePrior& prior) {
  const Eigen::Vector3d sigma{prior.roll_sigma, prior.pitch_sigma, prior.yaw_sigma};
  const Eigen::Vector3d expected{prior.attitude_GB.roll, prior.attitude_GB.pitch,
                                 prior.attitude_GB.yaw};
  for (int i = 0; i < 3; ++i) {
    const double off = wrap_angle(angles(i) - expected(i)), weight = 1.0 / (sigma(i) * sigma(i));
    n.C(i, i) += weight;
    n.c(i) += weight * off;
    n.cost += weight * off * off;
  }
}

struct Step {
  Eigen::Vector3d p, angles;
};

/// Solves (H + damping · diag H) step = -gradient by elimination of the position.
Step step_of(const Normal& n, double damping) {
  Eigen::Matrix3d A = n.A, C = n.C;
  A.diagonal() *= 1.0 + damping;
  C.diagonal() *= 1.0 + damping;
  const Eigen::Matrix3d A_inverse = A.inverse();
  const Eigen::Matrix3d BtA = n.B.transpose() * A_inverse;
  const Eigen::Vector3d angles = -((C - BtA * n.B).inverse() * (n.c - BtA * n.a));
  return {-(A_inverse * (n.a + n.B * angles)), angles};
}

}  // namespace

Turned turned(const Eigen::Vector3d& angles) {
  const auto [sr, cr] = sincos(angles.x());
  const auto [sp, cp] = sincos(angles.y());
  const auto [sy, cy] = sincos(angles.z());
  Turned t;
  t.R_GB << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,        //
      -sp, cp * sr, cp * cr;
  t.axes_B << 1.0, 0.0, -sp,  //
      0.0, cr, cp * sr,       //
      0.0, -sr, cp * cr;
  return t;
}

std::optional<Sights> sights_of(const GateObservations& seen, const CameraRig& rig) {
  constexpr double kStep = 1e-6;
  Sights sights;
  for (const GateObservation& one : seen) {
    const auto bearing_C = rig.lens.bearing(one.px);
    if (!bearing_C || !(bearing_C->z() > kLeastDepth)) return std::nullopt;
    const Eigen::Vector2d m = bearing_C->head<2>() / bearing_C->z();
    const auto right = rig.lens.project({m.x() + kStep, m.y(), 1.0}),
               below = rig.lens.project({m.x(), m.y() + kStep, 1.0});
    if (!right || !below) return std::nullopt;
    Eigen::Matrix2d slope;
    slope << *right - one.px, *below - one.px;
    sights.push_back({m, slope / (kStep * one.sigma_px), one.point_G, one.along_G,
                      one.sigma_px * one.sigma_px, !one.along_G.isZero(0.0)});
  }
  return sights;
}

std::optional<Normal> normal_at(const Pose& pose, const Sights& sights, Active active,
                                const PosePrior& prior, const CameraRig& rig) {
  const Turned body = turned(pose.angles);
  const Eigen::Matrix3d R_BG = body.R_GB.transpose();
  const Eigen::Matrix3d R_CB = rig.R_BC.matrix.transpose();
  const Eigen::Vector3d camera_B = pose.p_GB_B + rig.p_BC;  // from the gate
  Normal n{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(),
           Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0.0};
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if ((active >> i & 1u) == 0) continue;
    const Sight& sight = sights[i];
    Eigen::Vector3d point_B = R_BG * sight.point_G;
    const Eigen::Vector3d along_B = R_BG * sight.along_G;
    if (sight.line)
      point_B +=
          nearest_along(point_B - camera_B, along_B, rig.R_BC.matrix * sight.m.homogeneous()) *
          along_B;
    const Eigen::Vector3d q_C = R_CB * (point_B - camera_B);
    if (!(q_C.z() > kLeastDepth)) return std::nullopt;
    const double inverse_depth = 1.0 / q_C.z();
    const Eigen::Vector2d m = q_C.head<2>() * inverse_depth;
    const Eigen::Vector2d r = sight.whitening * (m - sight.m);
    // ∂m/∂q = (I₂ | -m) / depth
    Eigen::Matrix<double, 2, 3> K_C;
    K_C.leftCols<2>() = sight.whitening * inverse_depth;
    K_C.col(2) = -(K_C.leftCols<2>() * m);
    const Eigen::Matrix<double, 2, 3> K = K_C * R_CB;
    if (sight.line) {
      // Along the line's image nothing is known.
      const Eigen::Vector2d along = K * along_B;
      const double length = along.norm();
      if (!(length > 0.0)) continue;
      const Eigen::Vector2d normal{-along.y() / length, along.x() / length};
      const Eigen::Vector3d k = K.transpose() * normal;
      add(n, normal.dot(r), k, k.cross(point_B));
    } else {
      for (int row = 0; row < 2; ++row) {
        const Eigen::Vector3d k = K.row(row).transpose();
        add(n, r(row), k, k.cross(point_B));
      }
    }
  }
  if (std::isfinite(prior.z_sigma)) {
    const Eigen::Vector3d k = -R_BG.col(2) / prior.z_sigma;
    add(n, (R_BG.col(2).dot(pose.p_GB_B) - prior.z) / prior.z_sigma, k, k.cross(pose.p_GB_B));
  }
  // From a small turn to the three angles.
  n.B = (n.B * body.axes_B).eval();
  n.C = (body.axes_B.transpose() * n.C * body.axes_B).eval();
  n.c = (body.axes_B.transpose() * n.c).eval();
  add_attitude_prior(n, pose.angles, prior);
  return n;
}

std::optional<Fit> descend(const Pose& start, const Sights& sights, Active active,
                           const PosePrior& prior, const CameraRig& rig, int max_steps) {
  constexpr double kSmall = 1e-7;  // decrease of the chi-square that ends it
  auto normal = normal_at(start, sights, active, prior, rig);
  if (!normal) return std::nullopt;
  Fit fit{start, *normal, false};
  double damping = 0.0;
  for (int i = 0; i < max_steps && !fit.converged; ++i) {
    const Step step = step_of(fit.normal, damping);
    const double decrease = -(fit.normal.a.dot(step.p) + fit.normal.c.dot(step.angles));
    const Pose next{fit.pose.p_GB_B + step.p, fit.pose.angles + step.angles};
    normal = decrease >= 0.0 ? normal_at(next, sights, active, prior, rig) : std::nullopt;
    if (normal && normal->cost <= fit.normal.cost + kSmall) {
      fit.pose = next;
      fit.normal = *normal;
      fit.converged = decrease < kSmall;
      damping *= 0.1;
      if (damping < 1e-4) damping = 0.0;
    } else {
      damping = std::max(1e-2, 10.0 * damping);
    }
  }
  return fit;
}

}  // namespace gatefly::reprojection
