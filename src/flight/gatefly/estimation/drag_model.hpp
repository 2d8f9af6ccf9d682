// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace gatefly::drag_model {

/// Process model of the drag filter, Li18 §3.3: velocity from drag, so a bias integrates only once.
///
/// State, Eq. (20): position in the frame of the target gate [m], velocity along body z [m/s],
/// accelerometer bias in B [m/s²].
enum Index : int { kX, kY, kZ, kVz, kBiasX, kBiasY, kBiasZ, kStates };
using State = Eigen::Matrix<double, kStates, 1>;
using StateMatrix = Eigen::Matrix<double, kStates, kStates>;

/// Eq. (21).
struct Input {
  double roll = 0.0, pitch = 0.0;  ///< From the AHRS [rad], intrinsic z-y-x.
  double yaw = 0.0;                ///< Relative to the frame of the position [rad].
  Eigen::Vector3d accel_B = Eigen::Vector3d::Zero();  ///< Specific force, bias included [m/s²].
  Eigen::Vector3d gyro_B = Eigen::Vector3d::Zero();   ///< p, q, r [rad/s].
  double yaw_sigma = 0.0;  ///< How well the yaw is known [rad]; a systematic error.
};

struct Params {
  /// k_x, k_y of Eq. (13) [1/s], negative. [14 recorded flights]
  Eigen::Vector2d drag{-0.52, -0.47};
  double gravity = 9.81;  ///< [m/s²]
};

/// Eq. (14): body velocity as drag shows it, K⁻¹ (a − b); z is the state.
[[nodiscard]] Eigen::Vector3d velocity_B(const State& x, const Input& u, const Params& params);

/// Eq. (19): ẋ = f(x, u).
[[nodiscard]] State derivative(const State& x, const Input& u, const Params& params);

/// ∂f/∂x.
[[nodiscard]] StateMatrix jacobian(const State& x, const Input& u, const Params& params);

}  // namespace gatefly::drag_model
