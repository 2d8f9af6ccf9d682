// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/stray_gate.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"
#include "gatefly/pose/map_pose.hpp"

namespace gatefly {

std::optional<GateFrame> place_of(const Quad& corners_px, double side,
                                  const eskf::ErrorStateFilter& filter, double ago,
                                  const CameraRig& rig, const PoseParams& pose) {
  constexpr double kAnyYaw = 0.8;  // [rad] Its direction is free, but for the face that shows.
  const eskf::Nominal& x = filter.now();
  const Eigen::Matrix3d R_EB = x.R_EB * rotation_of(-ago * x.rate_B);
  const double target_yaw = filter.target_yaw();
  GateObservations corners;
  if (!add_corners(corners, corners_px, side, pose.corner_sigma_px)) return std::nullopt;
  CameraRig found = rig;
  found.R_BC.matrix = x.R_BC;
  const PosePrior prior{.attitude_GB = attitude_of(RotationEB{rotation_z(-target_yaw) * R_EB}),
                        .yaw_sigma = kAnyYaw};
  const auto [seen, reason] = map_pose(corners, prior, found, {.max_outliers = 0.0});
  if (!seen) return std::nullopt;
  const double yaw_EB = attitude_of(RotationEB{R_EB}).yaw;
  GateFrame place;
  place.yaw_EG = wrap_angle(yaw_EB - seen->attitude_GB.yaw);
  place.p_EG = x.p_EB - ago * x.v_E - rotation_z(place.yaw_EG) * seen->p_GB;
  return place;
}

bool is_another_gate(const Eigen::Vector3d& place_E, double sigma, const eskf::Landmarks& map,
                     std::size_t target, const StrayParams& params) {
  for (std::size_t i = 0; i < map.size(); ++i)
    if (i != target && (map.map(i).p_EG - place_E).norm() < params.least_off + sigma) return true;
  return false;
}

void StrayGate::seen(const GateFrame& place, double sigma, double time) {
  const bool goes_on = count_ > 0 && time - last_ < params_.pause &&
                       (place.p_EG - mean_.p_EG).norm() < params_.one_place;
  if (!goes_on) mean_ = place, sigma_ = sigma, count_ = 0, first_ = time;
  ++count_;
  last_ = time;
  sigma_ = std::min(sigma_, sigma);
  const double part = 1.0 / count_;
  mean_.p_EG += part * (place.p_EG - mean_.p_EG);
  mean_.yaw_EG = wrap_angle(mean_.yaw_EG + part * wrap_angle(place.yaw_EG - mean_.yaw_EG));
}

std::optional<GateFrame> StrayGate::instead_of(const GateFrame& map) const {
  if (count_ < params_.least || last_ - first_ < params_.least_for) return std::nullopt;
  const Eigen::Vector3d off = mean_.p_EG - map.p_EG;
  const double far = off.head<2>().norm();
  const bool may_be = far > params_.least_off && far > params_.own_sigmas * sigma_ &&
                      far < params_.farthest && std::abs(off.z()) < params_.height &&
                      std::abs(wrap_angle(mean_.yaw_EG - map.yaw_EG)) < params_.turned;
  if (!may_be) return std::nullopt;
  return mean_;
}

bool StrayGate::expects_target(const eskf::ErrorStateFilter& filter,
                               const Eigen::Vector3d& p_BC) const {
  if (!(filter.sigma(eskf::kTheta + 2) < params_.heading_sigma)) return false;
  const eskf::Nominal& x = filter.now();
  const Eigen::Vector3d p_BG = x.R_EB.transpose() * (filter.target().p_EG - x.p_EB);
  const Eigen::Vector3d p_CG = x.R_BC.transpose() * (p_BG - p_BC);
  return p_CG.norm() < params_.within && p_CG.z() > gatefly::cos(params_.in_view) * p_CG.norm();
}

}  // namespace gatefly
