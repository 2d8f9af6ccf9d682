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

// A point (x, y, 1) as Brown and Conrady's lens draws it, and how that moves with (x, y).
struct Distorted {
  Eigen::Vector2d m;
  Eigen::Matrix2d jacobian;
};

Distorted distorted(const RadialPolynomial& radial, const Eigen::Vector2d& tangential,
                    const Eigen::Vector2d& m) {
  const double x = m.x(), y = m.y(), s = m.squaredNorm();
  const double p1 = tangential.x(), p2 = tangential.y();
  const double a = radial.factor(s), mixed = 2 * p1 * x + 2 * p2 * y;
  const Eigen::Matrix2d shift{{2 * p1 * y + 6 * p2 * x, mixed}, {mixed, 6 * p1 * y + 2 * p2 * x}};
  return {a * m + Eigen::Vector2d{2 * p1 * x * y + p2 * (s + 2 * x * x),
                                  p1 * (s + 2 * y * y) + 2 * p2 * x * y},
          a * Eigen::Matrix2d::Identity() + 2 * radial.factor_slope(s) * m * m.transpose() + shift};
}

// The point (x, y, 1) drawn at `drawn`. The radial part is undone by itself; from there Newton
// undoes the (small) tangential one, with steps halved until they stay in the field of view and
// come nearer.
std::optional<Eigen::Vector2d> undistorted(const RadialPolynomial& radial,
                                           const Eigen::Vector2d& tangential,
                                           const Eigen::Vector2d& drawn) {
  constexpr int kMaxSteps = 50;
  constexpr double kTolerance = 1e-13, kLeastPart = 1e-4;
  const double size = drawn.norm();
  const auto radius = radial.inverse(size);
  if (!radius && tangential.isZero(0.0)) return std::nullopt;

  // The tangential part may draw a little outside the radial part's edge.
  Eigen::Vector2d m = drawn * (size > 0.0 ? radius.value_or(0.9 * radial.limit()) / size : 1.0);
  Distorted now = distorted(radial, tangential, m);
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Vector2d error = drawn - now.m;
    if (error.norm() <= kTolerance * (1.0 + size)) return m;
    const Eigen::Vector2d newton = now.jacobian.inverse() * error;
    double part = 1.0;
    // At most as often as one can be halved before it is kLeastPart.
    for (; part > kLeastPart; part *= 0.5) {
      const Eigen::Vector2d next = m + part * newton;
      if (!(next.norm() < radial.limit())) continue;
      now = distorted(radial, tangential, next);
      if ((drawn - now.m).norm() < error.norm()) break;
    }
    if (part <= kLeastPart) return std::nullopt;
    m += part * newton;
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

// With q = |(p1, p2)| r and c the cosine between m and (p2, p1), the jacobian in the directions
// along and across m is ((g' + 6 q c, ±2 q √(1 - c²)), (., a + 2 q c)). g' > 7 q up to the limit
// makes a > 3.5 q and the determinant positive for every c: the lens is then one-to-one within that
// disc.
BrownConrady::BrownConrady(const Eigen::Vector2d& focal, const Eigen::Vector2d& center,
                           const Coefficients& distortion)
    : focal_px{focal},
      center_px{center},
      radial_{{distortion[0], distortion[1], distortion[4], 0.0},
              7.0 * Eigen::Vector2d{distortion[2], distortion[3]}.norm()},
      tangential_{distortion[2], distortion[3]} {}

BrownConrady::Coefficients BrownConrady::distortion() const {
  const auto& k = radial_.coefficients();
  return {k[0], k[1], tangential_.x(), tangential_.y(), k[2]};
}

std::optional<Eigen::Vector2d> BrownConrady::project(const Eigen::Vector3d& p_C) const {
  if (!in_front(p_C)) return std::nullopt;
  const Eigen::Vector2d m = p_C.head<2>() / p_C.z();
  if (!(m.norm() < limit())) return std::nullopt;
  return Eigen::Vector2d{center_px + focal_px.cwiseProduct(distorted(radial_, tangential_, m).m)};
}

std::optional<Eigen::Vector3d> BrownConrady::bearing(const Eigen::Vector2d& px) const {
  if (!px.allFinite()) return std::nullopt;
  const auto m = undistorted(radial_, tangential_, (px - center_px).cwiseQuotient(focal_px));
  if (!m) return std::nullopt;
  const Eigen::Vector3d bearing_C = Eigen::Vector3d{m->x(), m->y(), 1.0}.normalized();
  return in_front(bearing_C) ? std::optional{bearing_C} : std::nullopt;
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

std::optional<Eigen::Vector2d> vanishing_point_px(const AnyCamera& lens,
                                                  const Eigen::Vector3d& direction_C) {
  if (!(std::abs(direction_C.z()) > 0.05 * direction_C.norm())) return std::nullopt;
  const auto axis = lens.project({0, 0, 1}), beside = lens.project({0.01, 0.01, 1});
  if (!axis || !beside) return std::nullopt;
  const Eigen::Vector2d focal_px = (*beside - *axis) / 0.01;
  return Eigen::Vector2d{*axis + focal_px.cwiseProduct(direction_C.head<2>() / direction_C.z())};
}

}  // namespace gatefly
