// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace gatefly::world {

/// A part of the flight: from when on and how long [s]. A length of 0 is never.
using During = Eigen::Vector2d;

[[nodiscard]] inline bool within(const During& part, double time) {
  return time >= part.x() && time < part.x() + part.y();
}

/// Faults of a flight: none, unless somebody asks. [docs/simulation.md, "Faults"]
///
/// Gates and rotors count from 1; 0 is none of the gates, all of the rotors. What is "beside" adds to
/// what the seed draws.
struct Faults {
  // Camera.
  double camera_drop = 0.0;   ///< Part of the pictures that never arrive, beside the usual.
  During camera_out{0, 0};    ///< No pictures at all.
  During camera_stuck{0, 0};  ///< The last picture again, with new time stamps.
  /// That much later than the calibration says; less than 0: younger, but not before read-out's end
  /// [s].
  double camera_delay = 0.0;
  double camera_tilt = 0.0;  ///< Tilted down by that much more, beside the usual [rad].
  double focal = 0.0;        ///< Longer by that part of itself, beside the usual.
  During light_out{0, 0};    ///< Every lamp at a fiftieth.
  double hue = 0.0;          ///< Gates of another hue than the configuration's [rad].
  // IMU.
  During imu_stuck{0, 0};                        ///< The last sample again.
  During imu_nan{0, 0};                          ///< Not numbers.
  double accel_range = 78.0, gyro_range = 17.4;  ///< [m/s²], [rad/s]
  double bias_step_at = 0.0;                     ///< When the two below appear [s].
  Eigen::Vector3d accel_bias_step{0, 0, 0};      ///< [m/s²]
  Eigen::Vector3d gyro_bias_step{0, 0, 0};       ///< [rad/s]
  Eigen::Vector2d imu_tilt{0, 0};                ///< Mounted rolled and pitched by this [rad].
  Eigen::Vector2d time_jump{0, 0};               ///< When, by how much the clock jumps [s].
  // Height.
  double sonar_drop = 0.0;  ///< Part of the readings that never arrive, beside the usual.
  During sonar_out{0, 0};
  // Gates.
  int moved_gate = 0;                   ///< -1: one that the seed draws.
  Eigen::Vector3d gate_moved{0, 0, 0};  ///< North, east, down [m].
  double gate_aside = 0.0;              ///< And to its own right [m].
  double gate_turned = 0.0;             ///< [rad]
  /// All gates so much farther from the pad, in the floor plan, than the map says: a part.
  double course_scale = 0.0;
  int missing_gate = 0;  ///< Not there at all: the race cannot be finished.
  int hidden_gate = 0;
  double gate_hidden = 0.0;  ///< Not to be seen from farther away than this [m].
  int false_gates = 0;       ///< Gates like the others that are not in the map.
  // Start, rotors and air.
  double start_heading = 0.0;  ///< Turned clockwise on the pad, beside the usual [rad].
  /// Hovering takes so much more of the thrust command: rotors give 1 / (1 + this) of their thrust.
  double hover_thrust = 0.0;
  double thrust_loss = 0.0;  ///< Part of the thrust.
  int weak_rotor = 0;
  During thrust_loss_during{0, 1e9};
  double battery_sag = 0.0;    ///< Part of the thrust lost by sag_time, beside the usual.
  Eigen::Vector2d wind{0, 0};  ///< Beside the usual: towards north, east [m/s].
  During wind_during{0, 1e9};
};

}  // namespace gatefly::world
