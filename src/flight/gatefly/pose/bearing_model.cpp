// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/bearing_model.hpp"

#include <Eigen/Geometry>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly {
namespace {

constexpr double kNearest = 0.15;  // before the lens [m]

// Right and down where `seen` touches the unit sphere.
Eigen::Matrix<double, 2, 3> tangents(const Eigen::Vector3d& seen) {
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(seen).normalized();
  Eigen::Matrix<double, 2, 3> E;
  E << right.transpose(), seen.cross(right).transpose();
  return E;
}

}  // namespace

// h = E ĉ', c' = (x a, y a, z), a = 1 + focal + bend (x² + y²) / z², c = R_BCᵀ (R_EBᵀ (p - p_EB) - p_BC).
std::optional<PointBearing> point_bearing(const Eigen::Vector3d& point_E,
                                          const Eigen::Vector3d& seen_C, const CameraPose& camera) {
  const Eigen::Vector3d d_E = point_E - camera.p_EB;
  const Eigen::Vector3d c = camera.R_BC.transpose() * (camera.R_EB.transpose() * d_E - camera.p_BC);
  if (!(c.z() > kNearest)) return std::nullopt;
  const double slope2 = c.head<2>().squaredNorm() / (c.z() * c.z());
  const double a = 1.0 + camera.focal + camera.bend * slope2;
  const Eigen::Vector3d drawn{a * c.x(), a * c.y(), c.z()};
  const double length = drawn.norm();
  const Eigen::Vector3d predicted = drawn / length;

  const Eigen::Matrix<double, 2, 3> E = tangents(seen_C);
  const Eigen::Matrix<double, 2, 3> by_drawn =
      E * (Eigen::Matrix3d::Identity() - predicted * predicted.transpose()) / length;
  // ∂c'/∂c, whose bend part is of a's dependence on c.
  const double k = 2.0 * camera.bend / (c.z() * c.z());
  Eigen::Matrix3d lens = Eigen::Vector3d{a, a, 1.0}.asDiagonal();
  lens.topRows<2>() += c.head<2>() * Eigen::RowVector3d{k * c.x(), k * c.y(), -k * slope2 * c.z()};
  const Eigen::Matrix<double, 2, 3> by_c = by_drawn * lens;

  PointBearing out;
  out.residual = E * (seen_C - predicted);
  out.by_point = by_c * camera.R_BC.transpose() * camera.R_EB.transpose();
  out.by_turn = out.by_point * skew(d_E);
  out.by_mount = by_c * skew(c);
  out.by_focal = by_drawn.leftCols<2>() * c.head<2>();
  out.by_bend = slope2 * out.by_focal;
  return out;
}

// The point of the line that is nearest to the ray, and of its residual the part across the line: moving
// the point along the line changes nothing of that.
std::optional<LineBearing> line_bearing(const Eigen::Vector3d& point_E,
                                        const Eigen::Vector3d& along_E,
                                        const Eigen::Vector3d& seen_C, const CameraPose& camera) {
  constexpr double kLeast = 0.04;  // sin² of ray and line
  const Eigen::Vector3d ray = camera.R_EB * (camera.R_BC * seen_C);
  const Eigen::Vector3d from = point_E - (camera.p_EB + camera.R_EB * camera.p_BC);
  const double cosine = ray.dot(along_E);
  const double sin2 = 1.0 - cosine * cosine;
  if (!(sin2 > kLeast)) return std::nullopt;
  const double along = (cosine * ray.dot(from) - along_E.dot(from)) / sin2;
  const auto point = point_bearing(point_E + along * along_E, seen_C, camera);
  if (!point) return std::nullopt;
  const Eigen::Vector2d image = (point->by_point * along_E).normalized();
  const Eigen::RowVector2d across{-image.y(), image.x()};
  LineBearing out;
  out.residual = across * point->residual;
  out.by_point = across * point->by_point;
  out.by_turn = across * point->by_turn;
  out.by_mount = across * point->by_mount;
  out.by_focal = across * point->by_focal;
  out.by_bend = across * point->by_bend;
  out.distance = (from + along * along_E).norm();
  return out;
}

}  // namespace gatefly
