// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include <Eigen/Core>

#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/pose/map_pose.hpp"

/// Parts of map_pose: reprojection errors, their derivatives, and the descent.
namespace gatefly::reprojection {

/// An observation without its lens: on the plane at depth 1 of a straight camera.
struct Sight {
  Eigen::Vector2d m;          ///< (X/Z, Y/Z) in C.
  Eigen::Matrix2d whitening;  ///< ∂px/∂m / σ: turns an error of m into standard deviations.
  Eigen::Vector3d point_G, along_G;
  double variance_px;
  bool line;
};
using Sights = FixedList<Sight, GateObservations::kCapacity>;
/// Bit i: sight i counts.
using Active = unsigned;
static_assert(Sights::kCapacity < std::numeric_limits<Active>::digits);

/// The observations through the lens; nullopt when one is outside of it.
[[nodiscard]] std::optional<Sights> sights_of(const GateObservations& seen, const CameraRig& rig);

/// Position and attitude that are tried. In the body's axes the picture alone tells the position,
/// almost whatever the attitude: the descent is shorter than with p_GB.
struct Pose {
  Eigen::Vector3d p_GB_B;  ///< The body relative to the gate, in B [m].
  Eigen::Vector3d angles;  ///< Roll, pitch, yaw relative to the gate [rad].
};

/// Half the Hessian (Gauss-Newton) and gradient of the cost, in blocks of position and angles.
struct Normal {
  Eigen::Matrix3d A, B, C;  ///< [A B; Bᵀ C]
  Eigen::Vector3d a, c;
  double cost;
};

/// R_GB, and the axes about which roll, pitch and yaw turn the body, in B.
struct Turned {
  Eigen::Matrix3d R_GB, axes_B;
};
[[nodiscard]] Turned turned(const Eigen::Vector3d& angles);

/// Cost and derivatives at a pose; nullopt when something seen would be behind the camera.
[[nodiscard]] std::optional<Normal> normal_at(const Pose& pose, const Sights& sights, Active active,
                                              const PosePrior& prior, const CameraRig& rig);

struct Fit {
  Pose pose;
  Normal normal;  ///< There.
  bool converged;
};

/// Levenberg-Marquardt from `start`; nullopt when the start itself is behind.
[[nodiscard]] std::optional<Fit> descend(const Pose& start, const Sights& sights, Active active,
                                         const PosePrior& prior, const CameraRig& rig,
                                         int max_steps);

}  // namespace gatefly::reprojection
