// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace gatefly {

/// The rotation about `turn`'s direction by its length [rad]: the exponential map of SO(3).
[[nodiscard]] Eigen::Matrix3d rotation_of(const Eigen::Vector3d& turn);

/// The rotation vector of R, of at most π [rad]: rotation_of's inverse but near half turns.
[[nodiscard]] Eigen::Vector3d turn_of(const Eigen::Matrix3d& R);

}  // namespace gatefly
