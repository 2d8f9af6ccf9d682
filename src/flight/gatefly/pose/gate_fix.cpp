// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/gate_fix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/pose/map_pose.hpp"
#include "gatefly/pose/ray_intersection.hpp"

namespace gatefly {
namespace {

bool within_reach(const Eigen::Vector3d& p_GB, const PoseParams& params) {
  return p_GB.x() <= 0.0 && std::abs(p_GB.y()) <= params.max_lateral &&
         p_GB.norm() <= params.max_distance;
}

// Angle that one pixel covers at `px` [rad].
double radians_per_px(const CameraRig& rig, const Eigen::Vector2d& px,
                      const Eigen::Vector3d& bearing_C) {
  const auto left = rig.lens.bearing(px - Eigen::Vector2d{0.5, 0.0});
  const auto right = rig.lens.bearing(px + Eigen::Vector2d{0.5, 0.0});
  return left && right ? (*right - *left).norm() : 0.006 * bearing_C.norm();
}

// Attitude errors turn the camera about the gate: δt = δθ × t.
Eigen::Matrix3d attitude_covariance(const Eigen::Vector3d& t_G, const PoseParams& params) {
  const double tilt = params.attitude_sigma * params.attitude_sigma;
  const double yaw = params.heading_sigma * params.heading_sigma;
  const Eigen::Matrix3d S = skew(t_G);
  return S * Eigen::Vector3d{tilt, tilt, yaw}.asDiagonal() * S.transpose();
}

// δp = δθ × p, and a wrong scale moves it along the line of sight.
Sensitivities sensitivities(const Eigen::Vector3d& p_GB, const PoseParams& params) {
  using Eigen::Vector3d;
  const double heading2 =
      params.heading_sigma * params.heading_sigma - params.gate_yaw_sigma * params.gate_yaw_sigma;
  Sensitivities L = Sensitivities::Zero();
  L.col(systematic::kTiltX) = params.attitude_sigma * Vector3d::UnitX().cross(p_GB);
  L.col(systematic::kTiltY) = params.attitude_sigma * Vector3d::UnitY().cross(p_GB);
  L.col(systematic::kHeading) = std::sqrt(std::max(0.0, heading2)) * Vector3d::UnitZ().cross(p_GB);
  L.col(systematic::kGateYaw) = params.gate_yaw_sigma * Vector3d::UnitZ().cross(p_GB);
  L.col(systematic::kScale) = params.scale_sigma * p_GB;
  return L;
}

struct YawError {
  double value, variance;
  double misfit;  ///< Mean squared residual in units of its noise; 4 degrees of freedom.
};

// Gauss-Newton over camera position and yaw, from the position that assumes the yaw is right.
std::optional<YawError> yaw_error(const std::array<Ray, 4>& rays,
                                  const std::array<double, 4>& sigma, Eigen::Vector3d t) {
  constexpr double kPriorVariance = 0.35 * 0.35;  // 20°: keeps a frontal far gate from spinning
  double yaw = 0.0;
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  double cost = 0.0;
  for (int iteration = 0; iteration < 4; ++iteration) {
    information.setZero();
    cost = 0.0;
    Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
    const Eigen::Matrix3d R = rotation_z(yaw);
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d to_corner = rays[i].point - t;
      const double d = to_corner.norm();
      if (!(d > 0.05)) return std::nullopt;
      // Residual across the measured ray, turned by the trial yaw.
      const Eigen::Vector3d v = R * rays[i].direction;
      const Eigen::Matrix3d N = Eigen::Matrix3d::Identity() - v * v.transpose();
      const Eigen::Vector3d r = N * to_corner / d;
      Eigen::Matrix<double, 3, 4> J;
      J.leftCols<3>() = -N / d;
      J.col(3) = -Eigen::Vector3d::UnitZ().cross(v);
      const double w = 1.0 / (sigma[i] * sigma[i]);
      information += w * J.transpose() * J;
      gradient += w * J.transpose() * r;
      cost += w * r.squaredNorm();
    }
    information(3, 3) += 1.0 / kPriorVariance;
    gradient(3) += yaw / kPriorVariance;
    const Eigen::Vector4d step = -information.ldlt().solve(gradient);
    if (!step.allFinite()) return std::nullopt;
    t += step.head<3>();
    yaw += step(3);
  }
  const Eigen::Matrix4d covariance = information.inverse();
  if (!covariance.allFinite() || !(covariance(3, 3) > 0.0)) return std::nullopt;
  // Take the prior out again: the filter that uses this has its own.
  const double posterior = covariance(3, 3);
  const double measured = 1.0 / std::max(1e-9, 1.0 / posterior - 1.0 / kPriorVariance);
  return YawError{yaw * measured / posterior, measured, cost / 4.0};
}

struct Sights {
  FixedList<Ray, 4> rays;
  FixedList<double, 4> sigma;  ///< Across each ray [rad].
};

// Noise of each ray, propagated through A t = b: δt = A⁻¹ Σ d_i δv_i. `scale` of the noise.
Eigen::Matrix3d ray_covariance(const Sights& sights, const Eigen::Vector3d& camera_G,
                               double scale) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero(), B = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < sights.rays.size(); ++i) {
    const Eigen::Vector3d& v = sights.rays[i].direction;
    const Eigen::Matrix3d N = Eigen::Matrix3d::Identity() - v * v.transpose();
    A += N;
    B += (sights.rays[i].point - camera_G).squaredNorm() * std::pow(scale * sights.sigma[i], 2) * N;
  }
  const Eigen::Matrix3d A_inverse = A.inverse();
  return A_inverse * B * A_inverse;
}

// Lines of sight to gate corners; nullopt when one is outside the lens.
std::optional<Sights> sights_to(std::span<const Eigen::Vector2d> px,
                                std::span<const Eigen::Vector3d> corners, const RotationGB& R_GB,
                                const CameraRig& rig, const PoseParams& params) {
  Sights sights;
  for (std::size_t i = 0; i < px.size(); ++i) {
    const auto bearing_C = rig.lens.bearing(px[i]);  // Eq. (5)
    if (!bearing_C) return std::nullopt;
    sights.rays.push_back({corners[i], R_GB * (rig.R_BC * *bearing_C)});  // Eq. (6)
    sights.sigma.push_back(params.corner_sigma_px * radians_per_px(rig, px[i], *bearing_C));
  }
  return sights;
}

struct Intersection {
  Fix fix;
  Eigen::Vector3d camera_G;
  double misfit;  ///< Mean squared miss of the rays in units of their noise.
};

// Eq. (9) with its covariance; nullopt when the rays do not meet before the gate.
std::optional<Intersection> intersection_of(const Sights& sights, const RotationGB& R_GB,
                                            const CameraRig& rig, const PoseParams& params) {
  const auto camera_G = nearest_point({sights.rays.begin(), sights.rays.size()});
  if (!camera_G) return std::nullopt;

  double cost = 0.0;
  for (std::size_t i = 0; i < sights.rays.size(); ++i) {
    const Eigen::Vector3d& v = sights.rays[i].direction;
    const Eigen::Vector3d to_corner = sights.rays[i].point - *camera_G;
    cost += (to_corner - v.dot(to_corner) * v).squaredNorm() /
            (to_corner.squaredNorm() * sights.sigma[i] * sights.sigma[i]);
  }
  Fix fix;
  fix.p_GB = *camera_G - R_GB * rig.p_BC;
  fix.covariance = ray_covariance(sights, *camera_G, 1.0) + attitude_covariance(*camera_G, params);
  if (!within_reach(fix.p_GB, params) || !fix.covariance.allFinite()) return std::nullopt;
  return Intersection{fix, *camera_G, cost / static_cast<double>(2 * sights.rays.size() - 3)};
}

}  // namespace

std::optional<Fix> fix_from_corners(const Quad& outer_corners_px, const RotationGB& R_GB,
                                    double side, const CameraRig& rig, const PoseParams& params) {
  const auto sights = sights_to(outer_corners_px, gate_corners_G(side), R_GB, rig, params);
  if (!sights) return std::nullopt;
  auto met = intersection_of(*sights, R_GB, rig, params);
  if (!met) return std::nullopt;
  const auto yaw = yaw_error(
      {sights->rays[0], sights->rays[1], sights->rays[2], sights->rays[3]},
      {sights->sigma[0], sights->sigma[1], sights->sigma[2], sights->sigma[3]}, met->camera_G);
  // Four corners that no square could have drawn, whatever the heading, are a wrong detection.
  if (!yaw || yaw->misfit > params.max_misfit) return std::nullopt;
  if (yaw->variance < 0.5) {  // beyond 40° it says nothing
    met->fix.yaw_error = yaw->value;
    met->fix.yaw_variance = yaw->variance;
  }
  return met->fix;
}

std::optional<Fix> map_fix_from_corners(const Quad& outer_corners_px, const RotationGB& R_GB,
                                        double side, const CameraRig& rig,
                                        const PoseParams& params) {
  GateObservations corners;
  add_corners(corners, outer_corners_px, side, params.corner_sigma_px);
  const PosePrior prior{.attitude_GB = attitude_of(RotationEB{R_GB.matrix}),
                        .roll_sigma = params.attitude_sigma,
                        .pitch_sigma = params.attitude_sigma,
                        .yaw_sigma = params.heading_sigma};
  // Three good corners and a bad one are a frame of two gates, and the three fit a gate elsewhere:
  // nothing is left out.
  const auto [pose, reason] = map_pose(corners, prior, rig, {.max_outliers = 0.0});
  if (!pose || !within_reach(pose->p_GB, params)) return std::nullopt;
  Fix fix{.p_GB = pose->p_GB, .covariance = pose->covariance.topLeftCorner<3, 3>()};
  const auto sights = sights_to(outer_corners_px, gate_corners_G(side), R_GB, rig, params);
  if (!sights) return std::nullopt;
  fix.random_covariance = ray_covariance(*sights, fix.p_GB + R_GB * rig.p_BC,
                                         params.random_sigma_px / params.corner_sigma_px);
  fix.systematic = sensitivities(fix.p_GB, params);
  // Take the prior out again: the filter that uses this has its own.
  const double before = prior.yaw_sigma * prior.yaw_sigma, after = pose->covariance(5, 5);
  const double measured = 1.0 / std::max(1e-9, 1.0 / after - 1.0 / before);
  if (measured < 0.5) {  // beyond 40° it says nothing
    fix.yaw_error = wrap_angle(pose->attitude_GB.yaw - prior.attitude_GB.yaw) * measured / after;
    fix.yaw_variance = measured;
  }
  return fix;
}

std::optional<Fix> fix_from_lower_corners(const LowerCorners& gate, const RotationGB& R_GB,
                                          double side, const CameraRig& rig,
                                          const PoseParams& params) {
  const auto corners = gate_corners_G(side);
  const std::array<Eigen::Vector2d, 2> px{gate.bottom_left_px, gate.bottom_right_px};
  const std::array<Eigen::Vector3d, 2> lower{corners[3], corners[2]};
  const auto sights = sights_to(px, lower, R_GB, rig, params);
  if (!sights) return std::nullopt;
  auto met = intersection_of(*sights, R_GB, rig, params);
  // One degree of freedom is left for a check: roll, and how level the gate stands.
  if (!met || met->misfit > 4.0 * params.max_misfit) return std::nullopt;
  met->fix.random_covariance =
      ray_covariance(*sights, met->camera_G, params.random_part_sigma_px / params.corner_sigma_px);
  met->fix.systematic = sensitivities(met->fix.p_GB, params);
  return met->fix;
}

std::optional<Fix> fix_from_bars(const GateBars& bars, const RotationGB& R_GB, double bar_distance,
                                 const CameraRig& rig, const PoseParams& params) {
  const auto left_C = rig.lens.bearing(bars.left_px);
  const auto right_C = rig.lens.bearing(bars.right_px);
  if (!left_C || !right_C) return std::nullopt;
  const Eigen::Vector3d left = R_GB * (rig.R_BC * *left_C);
  const Eigen::Vector3d right = R_GB * (rig.R_BC * *right_C);
  if (left.x() < 0.05 || right.x() < 0.05) return std::nullopt;  // beside the drone, not before it

  // Eq. (10), signed: the bars are where their bearings cut the gate plane.
  const double tan_left = left.y() / left.x(), tan_right = right.y() / right.x();
  const double spread = tan_right - tan_left;
  if (spread < 0.1) return std::nullopt;
  const double x = bar_distance / spread;
  const double y = 0.5 * bar_distance - x * tan_right;  // camera, right of the gate's axis
  const Eigen::Vector3d camera_G{-x, y, 0.0};
  const Eigen::Vector3d p_GB = camera_G - R_GB * rig.p_BC;
  if (x < params.min_bars_distance || x > params.max_bars_distance ||
      std::abs(p_GB.y()) > params.max_bars_lateral * bar_distance)
    return std::nullopt;

  // Each bearing with the corner noise; x_G = -s/spread, y_G = s/2 - s tan α₂ / spread.
  const double sigma_left = params.corner_sigma_px * radians_per_px(rig, bars.left_px, *left_C) *
                            (1 + tan_left * tan_left);
  const double sigma_right = params.corner_sigma_px * radians_per_px(rig, bars.right_px, *right_C) *
                             (1 + tan_right * tan_right);
  Eigen::Matrix2d J;  // of (x_G, y_G) by (tan α₁, tan α₂)
  J << -x / spread, x / spread, -tan_right * x / spread, tan_left * x / spread;
  const Eigen::Matrix2d noise =
      Eigen::Vector2d{sigma_left * sigma_left, sigma_right * sigma_right}.asDiagonal();
  Fix fix;
  fix.p_GB = {p_GB.x(), p_GB.y(), 0.0};
  fix.has_height = false;
  fix.covariance = attitude_covariance(camera_G, params);
  fix.covariance.topLeftCorner<2, 2>() += J * noise * J.transpose();
  fix.covariance.diagonal().head<2>().array() += std::pow(params.bars_sigma * std::max(1.0, x), 2);
  const double random_scale = params.random_part_sigma_px / params.corner_sigma_px;
  fix.systematic = sensitivities(fix.p_GB, params);
  fix.systematic.col(systematic::kScale) =
      params.bars_sigma * std::max(1.0, x) * Eigen::Vector3d::UnitX();
  fix.random_covariance.topLeftCorner<2, 2>() =
      random_scale * random_scale * J * noise * J.transpose();
  fix.covariance.row(2).setZero();
  fix.covariance.col(2).setZero();
  fix.covariance(2, 2) = 1.0;
  return fix;
}

}  // namespace gatefly
