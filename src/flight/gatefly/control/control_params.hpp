// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/geometry/math.hpp"

// Parameters of the controllers, fixed before take-off.

namespace gatefly {

/// The drone as its team knows it. Rotor order: left front, right front, right back, left back.
struct VehicleParams {
  double mass = 0.42;  ///< [kg] Bebop 1 with guards.
  /// Diagonal, body axes [kg m²]. [ours: box model]
  Eigen::Vector3d inertia{0.0021, 0.0020, 0.0035};
  /// Rotor distance from the centre along x, y [m].
  double arm_x = 0.112, arm_y = 0.095;
  /// Thrust / speed² [N/(rad/s)²]: hovers at 7,380 rpm.
  double thrust_coefficient = 1.72e-6;
  double torque_coefficient = 0.016;             ///< Yaw torque / thrust [m].
  double min_speed = 150.0, max_speed = 1250.0;  ///< Limits of a rotor [rad/s].
  double rotor_time_constant = 0.0185;           ///< [s] [Li18 code: 0.1 per 512 Hz sample]
};

struct IndiParams {
  /// On the error angle [1/s²]: ω_n² . [Li18 code: 200 -> 14.1 rad/s]
  double attitude_gain = 180.0;
  double rate_gain = 24.0;  ///< 2 ζ ω_n [1/s]. [Li18 code: 28]
  double yaw_attitude_gain = 20.0;
  double yaw_rate_gain = 9.0;
  double max_yaw_rate = 2.8;     ///< [rad/s] [Li18 code: 2.1; ours: tight arcs at 1.6 m/s need 2]
  double filter_hz = 11.0;       ///< Low-pass of rates and actuators. [Li18 code: 50 rad/s = 8 Hz]
  double filter_damping = 0.70;  ///< [Li18 code: 0.55]
  double sample_hz = 512.0;
  /// Rotor effectiveness is learnt in flight. [Smeur et al. 2016; off as flown, Li18 code]
  bool adaptive = false;
  double adaptation = 0.01;  ///< Step of the normalised LMS. [ours: a few seconds of flight]
  /// Changes from sample to sample below this say nothing [rad/s²]. [ours: gyro noise]
  double adaptation_floor = 0.3;
  /// Nominal effectiveness / this .. times this is believed. [estimate]
  double max_effectiveness_ratio = 3.0;
};

/// The pilot's output: to rotors, or to an autopilot.
enum class Output {
  kMotors,          ///< Rotor speeds, by Indi.
  kAttitudeThrust,  ///< Roll, pitch, yaw rate and thrust, for an autopilot that holds angles.
  kRatesThrust,     ///< Turn rates and thrust, for one that holds rates.
};

/// Attitude by way of an autopilot that holds rates.
struct RateParams {
  double attitude_gain = 6.0;  ///< Rate for an angle's error, roll and pitch [1/s]. [estimate]
  double yaw_gain = 2.5;       ///< The same for the heading [1/s]. [estimate]
  double max_rate = 4.0;       ///< Roll and pitch [rad/s]. [ours: half of what sticks give]
  /// A command shows in the motion so much later, and the thrust likewise [s]. [ours: link 0.03, smoothing
  /// 0.02, rotors 0.05]
  double response = 0.10;
};

struct AltitudeParams {
  double kp = 5.0;            ///< [(m/s²)/m] [Li18 code: 4.3]
  double kd = 3.6;            ///< [(m/s²)/(m/s)] [Li18 code: 1.1, which rings at ζ 0.26]
  double ki = 0.8;            ///< [(m/s²)/(m s)] carries battery sag and mass. [estimate]
  double max_accel = 4.0;     ///< [m/s²]
  double max_integral = 2.5;  ///< [m/s²]
};

struct LateralParams {
  /// [rad/m] [Li18 code: 0.35-0.50; ours: less, with more damping]
  double kp = 0.30;
  double kd = 0.26;                  ///< [rad s/m] [Li18 code: 0.20-0.25 effective]
  double max_roll = 25.0 * kDegree;  ///< [Li18 flight code]
};

}  // namespace gatefly
