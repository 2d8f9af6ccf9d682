// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sensing/camera.hpp"

#include <cmath>

#include <Eigen/LU>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

// 1e-6 rad of elevation: nearer to the lens plane than that is not an image point.
constexpr double kMinForward = 1e-6;

bool in_front(const Eigen::Vector3d& p_C) {
  return p_C.allFinite() && p_C.z() > kMinForward * p_C.norm() && p_C.z() > 0.0;
}

/// Where Brown and Conrady's lens draws the point (x, y, 1), and how that moves with (x, y).
struct Distorted {
  Eigen::Vector2d m;
  Eigen::Matrix2d jacobian;
  bool seen;  ///< Inside the field of view.
};

Distorted distorted(const BrownConrady& lens, const Eigen::Vector2d& m) {
  const double x = m.x(), y = m.y(), s = m.squaredNorm();
  const double p1 = lens.tangential.x(), p2 = lens.tangential.y();
  const double a = lens.radial.factor(s);
  Distorted d;
  d.m = a * m + Eigen::Vector2d{2 * p1 * x * y + p2 * (s + 2 * x * x), p1 * (s + 2 * y * y) + 2 * p2 * x * y};
  const double mixed = 2 * p1 * x + 2 * p2 * y;
  const Eigen::Matrix2d shift{{2 * p1 * y + 6 * p2 * x, mixed}, {mixed, 6 * p1 * y + 2 * p2 * x}};
  d.jacobian = a * Eigen::Matrix2d::Identity() + 2 * lens.radial.factor_slope(s) * m * m.transpose() + shift;
  // Beyond the limit the determinant may be positive again: turned over twice.
  d.seen = s < lens.radial.limit() * lens.radial.limit() && d.jacobian.determinant() > 0.0;
  return d;
}

/// The point (x, y, 1) drawn at `m`. The radial part is undone exactly; from there Newton undoes the
/// (small) tangential one, with steps halved until they stay in the field of view and come nearer.
std::optional<Eigen::Vector2d> undistorted(const BrownConrady& lens, const Eigen::Vector2d& m) {
  constexpr int kMaxSteps = 50;
  constexpr double kTolerance = 1e-13, kLeastPart = 1e-3;
  const double drawn = m.norm();
  if (drawn == 0.0 && lens.tangential.isZero(0.0)) return m;
  const auto radius = lens.radial.inverse(drawn);
  if (!radius && lens.tangential.isZero(0.0)) return std::nullopt;

  // The tangential part can draw a point outside the radial part's edge.
  Eigen::Vector2d x = drawn > 0.0 ? Eigen::Vector2d{m * (radius.value_or(0.9 * lens.radial.limit()) / drawn)} : m;
  Distorted now = distorted(lens, x);
  if (!now.seen) now = distorted(lens, x = Eigen::Vector2d::Zero());
  for (int step = 0; step < kMaxSteps && now.seen; ++step) {
    const Eigen::Vector2d error = m - now.m;
    if (error.norm() <= kTolerance * (1.0 + drawn)) return x;
    const Eigen::Vector2d newton = now.jacobian.inverse() * error;
    double part = 1.0;
    Distorted next = distorted(lens, x + newton);
    while (part > kLeastPart && !(next.seen && (m - next.m).norm() < error.norm())) {
      part *= 0.5;
      next = distorted(lens, x + part * newton);
    }
    if (part <= kLeastPart) return std::nullopt;
    x += part * newton;
    now = next;
  }
  return std::nullopt;
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

std::optional<Eigen::Vector2d> BrownConrady::project(const Eigen::Vector3d& p_C) const {
  if (!in_front(p_C)) return std::nullopt;
  const Distorted drawn = distorted(*this, p_C.head<2>() / p_C.z());
  if (!drawn.seen) return std::nullopt;
  return Eigen::Vector2d{center_px + focal_px.cwiseProduct(drawn.m)};
}

std::optional<Eigen::Vector3d> BrownConrady::bearing(const Eigen::Vector2d& px) const {
  if (!px.allFinite()) return std::nullopt;
  const auto m = undistorted(*this, (px - center_px).cwiseQuotient(focal_px));
  if (!m) return std::nullopt;
  return Eigen::Vector3d{m->x(), m->y(), 1.0}.normalized();
}

std::optional<Eigen::Vector2d> KannalaBrandt::project(const Eigen::Vector3d& p_C) const {
  if (!in_front(p_C)) return std::nullopt;
  const double side = std::sqrt(p_C.x() * p_C.x() + p_C.y() * p_C.y());
  const double angle = gatefly::atan2(side, p_C.z());
  if (!(angle < radial.limit())) return std::nullopt;
  if (side == 0.0) return center_px;
  return Eigen::Vector2d{center_px + focal_px.cwiseProduct(p_C.head<2>() * (radial(angle) / side))};
}

std::optional<Eigen::Vector3d> KannalaBrandt::bearing(const Eigen::Vector2d& px) const {
  if (!px.allFinite()) return std::nullopt;
  const Eigen::Vector2d m = (px - center_px).cwiseQuotient(focal_px);
  const double drawn = m.norm();
  const auto angle = radial.inverse(drawn);
  if (!angle || *angle >= 0.5 * kPi) return std::nullopt;
  if (drawn == 0.0) return Eigen::Vector3d{0, 0, 1};
  const auto [sine, cosine] = sincos(*angle);
  const Eigen::Vector2d side = m * (sine / drawn);
  const Eigen::Vector3d bearing_C{side.x(), side.y(), cosine};
  return in_front(bearing_C) ? std::optional{bearing_C} : std::nullopt;
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
