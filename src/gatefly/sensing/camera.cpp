// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sensing/camera.hpp"

#include <cmath>

namespace gatefly {
namespace {

// 1e-6 rad of elevation: nearer to the lens plane than that is not an image point.
constexpr double kMinForward = 1e-6;

bool in_front(const Eigen::Vector3d& p_C) {
  return p_C.allFinite() && p_C.z() > kMinForward * p_C.norm() && p_C.z() > 0.0;
}

}  // namespace

std::optional<Eigen::Vector2d> Pinhole::project(const Eigen::Vector3d& p_C) const {
  if (!in_front(p_C)) return std::nullopt;
  // Eq. (3)
  return Eigen::Vector2d{center_px.x() + focal_px.x() * p_C.x() / p_C.z(),
                         center_px.y() + focal_px.y() * p_C.y() / p_C.z()};
}

std::optional<Eigen::Vector3d> Pinhole::bearing(const Eigen::Vector2d& px) const {
  if (!px.allFinite()) return std::nullopt;
  // Eq. (5), normalised: Eq. (8) needs unit rays.
  return Eigen::Vector3d{(px.x() - center_px.x()) / focal_px.x(),
                         (px.y() - center_px.y()) / focal_px.y(), 1.0}
      .normalized();
}

std::optional<Eigen::Vector2d> DhaneFisheye::project(const Eigen::Vector3d& p_C) const {
  if (!in_front(p_C)) return std::nullopt;
  // sin of the drawn angle = sin of the true angle / k; tan from sin without any angle.
  const double norm = p_C.norm();
  const double side = std::sqrt(p_C.x() * p_C.x() + p_C.y() * p_C.y());
  const double sine = side / norm / k;
  if (sine >= 1.0) return std::nullopt;
  if (side == 0.0) return center_px;
  const double r_over_f = sine / std::sqrt(1.0 - sine * sine);
  return Eigen::Vector2d{center_px.x() + focal_px.x() * r_over_f * p_C.x() / side,
                         center_px.y() + focal_px.y() * r_over_f * p_C.y() / side};
}

std::optional<Eigen::Vector3d> DhaneFisheye::bearing(const Eigen::Vector2d& px) const {
  if (!px.allFinite()) return std::nullopt;
  const Eigen::Vector2d m = (px - center_px).cwiseQuotient(focal_px);
  const double r_over_f = m.norm();
  if (r_over_f == 0.0) return Eigen::Vector3d{0, 0, 1};
  const double sine = k * r_over_f / std::sqrt(1.0 + r_over_f * r_over_f);
  if (sine >= 1.0) return std::nullopt;
  const Eigen::Vector2d side = m * (sine / r_over_f);
  return Eigen::Vector3d{side.x(), side.y(), std::sqrt(1.0 - sine * sine)};
}

std::optional<Eigen::Vector2d> AnyCamera::project(const Eigen::Vector3d& p_C) const {
  return std::visit([&](const auto& lens) { return lens.project(p_C); }, model);
}

std::optional<Eigen::Vector3d> AnyCamera::bearing(const Eigen::Vector2d& px) const {
  return std::visit([&](const auto& lens) { return lens.bearing(px); }, model);
}

std::optional<Eigen::Vector2d> vanishing_point_px(const AnyCamera& lens, const Eigen::Vector3d& direction_C) {
  if (!(std::abs(direction_C.z()) > 0.05 * direction_C.norm())) return std::nullopt;
  const auto axis = lens.project({0, 0, 1}), beside = lens.project({0.01, 0.01, 1});
  if (!axis || !beside) return std::nullopt;
  const Eigen::Vector2d focal_px = (*beside - *axis) / 0.01;
  return Eigen::Vector2d{*axis + focal_px.cwiseProduct(direction_C.head<2>() / direction_C.z())};
}

}  // namespace gatefly
