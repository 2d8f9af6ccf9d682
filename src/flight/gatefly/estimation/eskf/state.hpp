// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace gatefly::eskf {

/// The index of each error in the state vector. Gates follow from kGates on, kPerGate each.
enum Index : int {
  kP = 0,           ///< Position in E [m].
  kV = 3,           ///< Velocity in E [m/s].
  kTheta = 6,       ///< Attitude: R_EB is off by rotation_of(θ) from the left [rad].
  kGyroBias = 9,    ///< [rad/s]
  kAccelBias = 12,  ///< [m/s²]
  kGust = 15,       ///< Air over ground: what changes within seconds, north and east [m/s] ...
  kWind = 17,       ///< ... and what stays [m/s].
  kDrag = 19,       ///< Relative error of k_x, k_y.
  kMount = 21,      ///< R_BC is off by rotation_of(m) from the right [rad].
  kFocal = 24,      ///< Relative, of the lens' scale ...
  kBend = 25,       ///< ... and of its bend: with the slope's square. See CameraPose.
  kDelay = 26,      ///< Pictures are so much younger than told [s].
  kCorner = 27,     ///< Systematic error of a gate's corners: right, down, size [rad].
  kThrust = 30,     ///< Relative, of the thrust that a command gives.
  kGates = 31
};
/// The errors of one gate: place in E [m], direction [rad], relative size.
enum GateIndex : int { kGateP = 0, kGateYaw = 3, kGateSize = 4, kPerGate = 5 };

inline constexpr std::size_t kMaxGates = 8;  ///< At a time; see Landmarks.
inline constexpr int kMaxStates = kGates + kPerGate * static_cast<int>(kMaxGates);

using ErrorVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxStates, 1>;
using Covariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStates, kMaxStates>;

/// A gate as believed.
struct GateBelief {
  Eigen::Vector3d p_EG = Eigen::Vector3d::Zero();  ///< [m]
  double yaw_EG = 0.0;                             ///< [rad]
  double size = 0.0;                               ///< Its side is 1 + size of the map's.
};

/// All that is believed; the errors of Index are errors of this.
struct Nominal {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero(), v_E = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_EB = Eigen::Matrix3d::Identity(), R_BC = Eigen::Matrix3d::Identity();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero(), accel_bias = Eigen::Vector3d::Zero();
  Eigen::Vector2d gust = Eigen::Vector2d::Zero(), wind = Eigen::Vector2d::Zero();
  Eigen::Vector2d drag = Eigen::Vector2d::Zero();  ///< Relative error of k_x, k_y.
  double focal = 0.0, bend = 0.0, delay = 0.0;
  double thrust = 0.0;  ///< Rotors give 1 + thrust times what was commanded.
  Eigen::Vector3d corner = Eigen::Vector3d::Zero();
  std::array<GateBelief, kMaxGates> gates{};

  // Not states of the filter, but of this moment, too:
  Eigen::Vector3d rate_B = Eigen::Vector3d::Zero();  ///< Bias removed [rad/s].
  double gust_sigma = 0.0;  ///< How strong gusts are, found from the states [m/s].
  double spread = 1.0;      ///< Variance of the corners' errors, relative; found from residuals.
  /// How strongly accelerometer and gyro shake, as a variance, relative; found from their samples.
  double accel_shaking = 1.0, gyro_shaking = 1.0;
  double thrust_misfit = 0.0;  ///< Mean residual of what rotors give, of the last 0.2 s [m/s²].
  double turned = 0.0;         ///< Heading by which corrections have turned it altogether [rad].
  int corner_of = -1;          ///< Gate and face that `corner` belongs to: 2 slot + face; -1: none.
};

/// Takes in errors that were found.
void add(Nominal& x, const ErrorVector& error);

/// First of the states of the gate in `slot`.
[[nodiscard]] inline int gate_at(int slot) { return kGates + kPerGate * slot; }

}  // namespace gatefly::eskf
