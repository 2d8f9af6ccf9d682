// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace gatefly {

/// The rotation E from the body's axes to the wanted ones in two: about a level axis until the thrust
/// points right, then about the thrust. However far the heading is off, the tilt goes the short way.
/// Brescianini & D'Andrea 2018.
/// @returns x and y: the tilt, z: the heading, in body axes [rad]
[[nodiscard]] Eigen::Vector3d tilt_then_yaw(const Eigen::Matrix3d& E);

}  // namespace gatefly
