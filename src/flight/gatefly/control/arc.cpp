// SPDX-License-Identifier: Apache-2.0
#include "gatefly/control/arc.hpp"

#include <algorithm>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly {

Eigen::Vector3d drag_F(const Eigen::Vector3d& v_F, double roll, double pitch,
                       const Eigen::Vector3d& drag) {
  const Eigen::Matrix3d R_FB = rotation_y(pitch) * rotation_x(roll);
  return R_FB * drag.cwiseProduct(R_FB.transpose() * v_F);  // Eq. (26)
}

AttitudeCommand step(Arc& arc, double dt, const ArcParams& params) {
  const double curvature = params.radius == 0.0 ? 0.0 : 1.0 / params.radius;
  const double yaw_rate = arc.v_F.x() * curvature;  // Eq. (24)
  const Eigen::Vector3d a_F = drag_F(arc.v_F, arc.roll, params.pitch, params.drag);
  const double lift = -params.gravity - a_F.z();  // Eq. (27): T cosθ cosφ, negative
  const double side = (a_F.y() - arc.v_F.x() * yaw_rate) * cos(params.pitch);
  const double roll = std::clamp(atan(side / lift), -params.max_roll, params.max_roll);  // Eq. (28)

  // Eq. (25), with the forces just commanded.
  const double T = lift / (cos(params.pitch) * cos(roll));
  const Eigen::Vector3d thrust_F =
      rotation_y(params.pitch) * rotation_x(roll) * Eigen::Vector3d{0, 0, T};
  const Eigen::Vector3d gravity{0, 0, params.gravity};
  const Eigen::Vector3d omega{0, 0, yaw_rate};
  const Eigen::Vector3d v_dot = gravity + thrust_F + a_F - omega.cross(arc.v_F);
  arc.v_F += dt * v_dot;
  arc.roll = roll;
  arc.yaw = wrap_angle(arc.yaw + yaw_rate * dt);  // Eq. (29)
  return {.roll = roll, .pitch = params.pitch, .yaw = arc.yaw, .yaw_rate = yaw_rate, .thrust = -T};
}

}  // namespace gatefly
