// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/pose_trial.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/pose/ray_intersection.hpp"

namespace gatefly::experiments {
namespace {

/// As a straight lens centred at the origin would draw them.
std::optional<Quad> straightened(const Quad& px, const CameraRig& rig) {
  Quad straight;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto bearing_C = rig.lens.bearing(px[i]);
    if (!bearing_C) return std::nullopt;
    straight[i] = kStudyFocalPx * bearing_C->head<2>() / bearing_C->z();
  }
  return straight;
}

}  // namespace

CameraRig study_rig() {
  return {AnyCamera{Pinhole{}}, camera_mount(20.0 * kDegree), Eigen::Vector3d::Zero()};
}

Quad corners_seen_from(const Eigen::Vector3d& p_GB, const Attitude& attitude_GB,
                       const CameraRig& rig) {
  const Eigen::Matrix3d R_GB = rotation_EB(attitude_GB).matrix;
  Quad px;
  for (std::size_t i = 0; i < 4; ++i)
    px[i] = rig.lens
                .project(rig.R_BC.matrix.transpose() *
                         (R_GB.transpose() * (gate_corners_G(1.0)[i] - p_GB) - rig.p_BC))
                .value();
  return px;
}

std::optional<Eigen::Vector3d> by_rays(const Quad& px, const Attitude& attitude_GB,
                                       const CameraRig& rig, double side) {
  const Eigen::Matrix3d R_GB = rotation_EB(attitude_GB).matrix;
  std::array<Ray, 4> rays;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto bearing_C = rig.lens.bearing(px[i]);
    if (!bearing_C) return std::nullopt;
    rays[i] = {gate_corners_G(side)[i], R_GB * (rig.R_BC * *bearing_C)};
  }
  const auto camera_G = nearest_point(rays, 0.0);
  if (!camera_G) return std::nullopt;
  return Eigen::Vector3d{*camera_G - R_GB * rig.p_BC};
}

std::optional<Eigen::Vector3d> by_pnp(Pnp method, const Quad& px, const CameraRig& rig,
                                      double side) {
  const auto straight = straightened(px, rig);
  return straight ? camera_by(method, *straight, kStudyFocalPx, side) : std::nullopt;
}

std::optional<Eigen::Vector3d> by_kneip(const KneipRule& rule, const Quad& px, const CameraRig& rig,
                                        double side) {
  const auto straight = straightened(px, rig);
  return straight ? camera_by_kneip(*straight, kStudyFocalPx, side, rule) : std::nullopt;
}

void Rmse::add(const std::optional<Eigen::Vector3d>& found, const Eigen::Vector3d& truth) {
  if (!found) {
    ++none;
    return;
  }
  const Eigen::Vector3d error = *found - truth;
  squares += error.cwiseAbs2(), sum += error, ++n;
}

bool reproduced(double ours, double paper) {
  return std::abs(ours - paper) <= std::max(0.1 * paper, 0.002);
}

void in_pieces(std::size_t count, const Options& options,
               const std::function<void(std::size_t)>& work) {
  constexpr std::size_t kPiece = 12;
  for (std::size_t from = 0; from < count; from += kPiece) {
    if (options.stopped()) throw Stopped{};
    options.progress(static_cast<double>(from) / static_cast<double>(count),
                     std::to_string(from) + " of " + std::to_string(count));
    in_parallel(std::min(kPiece, count - from), [&](std::size_t i) { work(from + i); });
  }
}

}  // namespace gatefly::experiments
