// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/collisions.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {

std::vector<Eigen::Vector3d> corners_of(const world::VehicleTruth& vehicle) {
  std::vector<Eigen::Vector3d> points;
  const Eigen::Vector3d half = 0.5 * vehicle.size;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0})
        points.push_back(half.cwiseProduct(Eigen::Vector3d{x, y, z}));
  return points;
}

std::vector<Eigen::Vector3d> outline_of(const world::VehicleTruth& vehicle) {
  std::vector<Eigen::Vector3d> points = corners_of(vehicle);
  constexpr int kRim = 12;  // points on each propeller's rim
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (int i = 0; i < kRim; ++i) {
        const auto [s, c] = sincos(2 * kPi * i / kRim);
        points.push_back({x * vehicle.arm_x + vehicle.propeller_radius * c,
                          y * vehicle.arm_y + vehicle.propeller_radius * s,
                          -0.5 * vehicle.size.z()});
      }
  return points;
}

Collisions::Collisions(const world::World& world, const world::VehicleTruth& vehicle)
    : half_{0.5 * vehicle.size} {
  for (const Solid& solid : solids_of(world))
    shapes_.push_back(
        {solid.name, solid.center_E, 0.5 * solid.size, rotation_z(-solid.heading), solid.pole});
}

bool Collisions::touches(const Shape& shape, const BodyState& state,
                         const Eigen::Matrix3d& R_EB) const {
  const Eigen::Vector3d apart_E = state.p_EB - shape.center_E;
  const Eigen::Vector3d apart = shape.R_SE * apart_E;
  const double reach = half_.norm();
  if (((apart.cwiseAbs() - shape.half).array() > reach).any()) return false;

  const Eigen::Matrix3d R_SB = shape.R_SE * R_EB;
  const auto separates = [&](const Eigen::Vector3d& axis) {
    const double body = (R_SB.transpose() * axis).cwiseAbs().dot(half_);
    const double solid =
        shape.pole ? shape.half.x() * axis.head<2>().norm() + shape.half.z() * std::abs(axis.z())
                   : axis.cwiseAbs().dot(shape.half);
    return std::abs(apart.dot(axis)) > body + solid;
  };
  // Faces of both, then edge against edge.
  for (int i = 0; i < 3; ++i) {
    if (separates(R_SB.col(i)) || separates(Eigen::Vector3d::Unit(i))) return false;
    for (int k = shape.pole ? 2 : 0; k < 3; ++k)
      if (separates(Eigen::Vector3d::Unit(k).cross(R_SB.col(i)))) return false;
  }
  if (!shape.pole) return true;
  // A pole has faces in all directions: those towards the body's corners decide.
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign{corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0,
                               corner & 4 ? 1.0 : -1.0};
    const Eigen::Vector3d at = apart + R_SB * half_.cwiseProduct(sign);
    if (separates({at.x(), at.y(), 0.0})) return false;
  }
  return true;
}

const std::string* Collisions::touched(const BodyState& state) const {
  const Eigen::Matrix3d R_EB = R_EB_of(state.q_EB);
  for (const Shape& shape : shapes_)
    if (touches(shape, state, R_EB)) return &shape.name;
  return nullptr;
}

}  // namespace gatefly::sim
