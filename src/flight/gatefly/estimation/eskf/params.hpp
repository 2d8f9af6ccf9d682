// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/geometry/math.hpp"

namespace gatefly::eskf {

/// Standard deviations of what is known before take-off. None is taken from the simulator:
/// data sheets, a tape measure, or an estimate, as said.
struct Priors {
  Eigen::Vector3d position{0.15, 0.15, 0.05};  ///< On the pad [m]. [tape measure and feet]
  double speed = 0.03;                         ///< [m/s] [standing]
  double tilt = 0.6 * kDegree;     ///< The pad's, and the feet's. [1 cm over 1 m: estimate]
  double heading = 3.5 * kDegree;  ///< The pad's. [by eye along a line: estimate]
  double gyro_bias = 0.005;        ///< After rest [rad/s]. [MPU-6050: 20 °/s over 125 °C; 2 °C]
  Eigen::Vector3d accel_bias{0.4, 0.4, 0.6};  ///< [m/s²]. [MPU-6050: 50, 50, 80 mg at 0 g]
  double rest_accel = 0.05;       ///< Change of the bias from rest to flight [m/s²]. [estimate]
  double wind = 0.5, gust = 0.6;  ///< [m/s]. [doors and fans .3; found from above: estimate]
  double drag = 0.12;             ///< Relative. [14 recorded flights: .48-.61]
  double thrust = 0.10;  ///< Relative. [hover throttle by eye, a battery's charge: estimate]
  Eigen::Vector3d mount = Eigen::Vector3d{2.0, 1.0, 1.0} * kDegree;  ///< Tilt, pan, roll. [bracket]
  double focal = 0.015, bend = 0.02;  ///< Relative. [calibrations of one lens: k 1.03-1.08]
  /// [s]. [a period at 30 Hz: so long a driver may hold a picture back. estimate]
  double delay = 0.030;
  double map = 0.12, map_height = 0.05;     ///< Place and height of a gate [m]. [tape measure]
  double map_yaw = 0.06, map_size = 0.012;  ///< [rad], relative. [by eye; built frames]
};

/// How an IMU shakes: the white part of its samples, summed over the axes, as spectral densities.
struct Shaking {
  double accel = 17.5 / 512.0;   ///< [(m/s²)²/Hz] [median of ten recorded flights, 512 Hz]
  double gyro = 0.0175 / 512.0;  ///< [(rad/s)²/Hz] [the same]
};

/// Process noise as spectral densities [unit²/s], and measurement noise.
struct Noise {
  double position = 1e-5;
  double accel = 1e-3, accel_z = 4e-3;  ///< [(m/s²)²/Hz]. [rotor vibration 2, 5 m/s² at 512 Hz]
  double attitude = 1.5e-5;             ///< [rad²/s] [gyro vibration .15 rad/s at 512 Hz]
  double gyro_scale = 0.01;  ///< Share of the angle turned in 1 s. [MPU-6050: 3 %, cross axis 2 %]
  double accel_bias = 1e-5, gyro_bias = 4e-8;  ///< [warm-up within minutes: estimate]
  double wind = 3e-4;                          ///< [draughts last for minutes: estimate]
  double drag = 1e-5;
  double thrust = 1e-6;             ///< [a battery sags by a tenth in two minutes]
  double drag_measurement = 0.004;  ///< [(m/s²)²/Hz] [20 Hz band .13-.18 m/s² of real flights]
  /// [(m/s²)²/Hz] [the accelerometer's own, and half of that for rotors in moving air: estimate]
  double thrust_measurement = 0.006;
  double gust_length = 1.7;      ///< [m] [MIL-F-8785C at 1.7 m height]
  double gust_adaptation = 0.3;  ///< [1/s] Gusts' strength is learnt so fast. [estimate]
  double least_gust = 0.04, greatest_gust = 1.5;  ///< [m/s] [office air .03-.08]
  Shaking shaking{};  ///< Vibration at which the densities above hold ...
  double least_shaking = 0.25,
         most_shaking = 16.0;  ///< ... and the range in which they follow the measured one.
  double shaking_lasts = 1.0;  ///< Averaging time of the measured vibration [s].
};

/// How far off corners are found [px]; the detector's own, on labelled and rendered pictures.
struct SightNoise {
  double own = 0.7;                                        ///< Each corner's.
  double together = 0.3, size = 0.3;                       ///< All four's in one picture ...
  double lasting = 0.4, lasting_size = 0.45, lasts = 4.0;  ///< ... and what stays, for so long [s].
  double part = 1.6, bars = 4.0;  ///< A corner of a cut-off gate; a bar's middle.
  double bar_lean = 0.03;         ///< Error of a bar's middle [m].
  /// Residuals may show so much more or less of it, as a variance. [estimate: three times as far off]
  double least_spread = 0.5, most_spread = 9.0;
  double spread_gain = 0.02;  ///< A picture counts so much in that. [2 s at 25 Hz]
};

struct Params {
  Priors priors;
  Noise noise;
  SightNoise sight;
  Eigen::Vector2d drag{-0.52, -0.47};  ///< k_x, k_y [1/s]. [14 recorded flights]
  double gravity = kGravity;           ///< [m/s²]
  double slowest_air = 0.5;            ///< Gusts pass at least so fast [m/s].
};

}  // namespace gatefly::eskf
