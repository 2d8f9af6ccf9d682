// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/geometry/frames.hpp"

namespace gatefly {

/// Orientation of the body in the earth frame as intrinsic z-y-x Euler angles [rad].
struct Attitude {
  double roll = 0.0;   ///< φ, positive right side down.
  double pitch = 0.0;  ///< θ, positive nose up: flying forward is negative.
  double yaw = 0.0;    ///< ψ, clockwise from north seen from above.
};

/// Elementary rotations, right-handed: rotation_z(a) * x̂ points at heading a.
[[nodiscard]] Eigen::Matrix3d rotation_x(double angle);
[[nodiscard]] Eigen::Matrix3d rotation_y(double angle);
[[nodiscard]] Eigen::Matrix3d rotation_z(double angle);

/// R_EB of an attitude: ℜ_B^E(φ,θ,ψ) = Rz(ψ) Ry(θ) Rx(φ).
[[nodiscard]] RotationEB rotation_EB(const Attitude& attitude);

/// The attitude of R_EB; at |pitch| = 90° roll is reported as 0.
[[nodiscard]] Attitude attitude_of(const RotationEB& R_EB);

/// Unit quaternion (w, x, y, z), body to earth.
struct Quaternion {
  double w = 1.0, x = 0.0, y = 0.0, z = 0.0;
};
[[nodiscard]] Quaternion quaternion_of(const Attitude& attitude);
[[nodiscard]] RotationEB rotation_EB(const Quaternion& q);
/// `q` after turning at `rate_B` [rad/s] for `dt` [s]; stays a unit quaternion.
[[nodiscard]] Quaternion integrated(const Quaternion& q, const Eigen::Vector3d& rate_B, double dt);

/// Camera orientation from its mount: pitched down by `tilt`, rolled by `roll` about its axis
/// [rad].
[[nodiscard]] RotationBC camera_mount(double tilt_down, double roll = 0.0);

/// v as a matrix: skew(a) * b = a × b.
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v);

}  // namespace gatefly
