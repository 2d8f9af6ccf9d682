// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "gatefly/experiments/lively_flight.hpp"

namespace gatefly::experiments {

/// Standard deviations of what shakes the IMU in the air, per axis.
struct Vibration {
  Eigen::Vector3d accel_low, accel_high;  ///< 3-20 Hz and above [m/s²].
  Eigen::Vector3d gyro_low, gyro_high;    ///< [rad/s]
};
[[nodiscard]] Vibration vibration_of(const LivelyFlight& flight);

/// Accelerometer against velocity through still air, both low-passed at 3 Hz: a = slope v + offset.
struct Drag {
  double slope = 0.0;  ///< [1/s]
  double correlation = 0.0;
};
/// @param axis  0: along the nose, 1: to the right.
[[nodiscard]] Drag drag_of(const LivelyFlight& flight, int axis);

/// Second-order system with a delay that follows a set point as the attitude did.
struct AttitudeResponse {
  double omega = 0.0, zeta = 0.0, delay = 0.0;  ///< [rad/s], -, [s]
  double rms = 0.0;                             ///< Misfit [rad].
  double half = 0.0;       ///< From a step of the set point until half of it is reached [s].
  double overshoot = 0.0;  ///< Part of a step's height.
};
/// @param axis  0: roll, 1: pitch. Least squares of output errors over the time in the air.
[[nodiscard]] AttitudeResponse response_of(const LivelyFlight& flight, int axis);

/// How the rotors follow what they are asked for.
struct RotorResponse {
  double lag = 0.0, delay = 0.0;  ///< First order, after a delay [s].
};
[[nodiscard]] RotorResponse rotors_of(const LivelyFlight& flight);

/// Effectiveness about roll and pitch: ω̇ = slope · difference of squared rotor speeds + air ·
/// specific force to the right, ahead (drag: what the air does goes with it) + constant; all
/// low-passed at 6 Hz.
struct Effectiveness {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();      ///< [rad/s² / (rad/s)²]
  Eigen::Vector2d air = Eigen::Vector2d::Zero();        ///< [rad/s² / (m/s²)]
  Eigen::Vector2d explained = Eigen::Vector2d::Zero();  ///< R².
};
[[nodiscard]] Effectiveness effectiveness_of(const LivelyFlight& flight);

/// Speed along the nose that long after the set point of the pitch first went below -2° in the air
/// [m/s]; nullopt when it had come down by then.
[[nodiscard]] std::optional<double> speed_after(const LivelyFlight& flight, double seconds);

}  // namespace gatefly::experiments
