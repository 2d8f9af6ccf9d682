// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/control/attitude_command.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {

struct ArcParams {
  double radius = 1.5;                      ///< > 0 turns right, < 0 left; 0 is straight ahead [m].
  double pitch = -5.0 * kDegree;            ///< θ_0. [Li18 §4]
  Eigen::Vector3d drag{-0.52, -0.47, 0.0};  ///< k_x, k_y, k_z [1/s]. [recorded flights]
  double gravity = kGravity;                ///< [m/s²]
  double max_roll = 40.0 * kDegree;
};

/// A level, slip-free turn flown without any position fix. Li18 §4, Eq. (24)-(29).
///
/// The arc owns the commanded heading and the predicted velocity; nothing is measured.
/// Sign: radius > 0 turns right, and a right turn rolls right (roll > 0).
struct Arc {
  /// Commanded heading; starts at the heading on entry [rad].
  double yaw = 0.0;
  /// Predicted velocity in F; starts at the estimate [m/s].
  Eigen::Vector3d v_F = Eigen::Vector3d::Zero();
  /// Last commanded, for the drag of the next step [rad].
  double roll = 0.0;
};

/// Eq. (26): drag acceleration in F for a velocity in F.
[[nodiscard]] Eigen::Vector3d drag_F(const Eigen::Vector3d& v_F, double roll, double pitch,
                                     const Eigen::Vector3d& drag);

/// One step of the arc: the command of Eq. (29), and the prediction of Eq. (25).
/// Differs: with the drag of the previous roll (a fixed point in one step), as flown.
AttitudeCommand step(Arc& arc, double dt, const ArcParams& params);

}  // namespace gatefly
