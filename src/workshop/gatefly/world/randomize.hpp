// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gatefly::world {

/// Sizes of what one seed varies: one standard deviation each, drawn cut at 2.5 σ.
/// [docs/simulation.md]
struct Randomize {
  double gate_position = 0.0, gate_heading = 0.0, gate_height = 0.0;  ///< [m], [rad], [m]
  double start_position = 0.0, start_heading = 0.0;                   ///< [m], [rad]
  double camera_focal = 0.0, camera_center_px = 0.0, camera_tilt = 0.0, camera_latency = 0.0;
  double camera_k =
      0.0;  ///< Dhane's k, of which a pinhole's is 1: 0.1 scales a picture by a tenth.
  double camera_k1 = 0.0;  ///< First coefficient of the polynomials; relative.
  double gate_side = 0.0;  ///< Relative.
  double drag = 0.0, mass = 0.0, thrust = 0.0, sag = 0.0;  ///< Relative; sag is not random.
  double accel_bias = 0.0, gyro_bias = 0.0, scale = 0.0;   ///< [m/s²], [rad/s], relative
  /// [m/s²] [ours: rectified vibration]
  double flight_bias = 0.0;
  double noise_scale = 1.0;
  double light = 0.0, exposure = 0.0, hue = 0.0, white_balance = 0.0,
         saturation = 0.0;  ///< Relative; hue [rad].
  double frame_loss = 0.0, latency_jitter = 0.0;
  double wind = 0.0, gust = 0.0;              ///< [m/s]
  double jet = 0.0, shear = 0.0, wash = 0.0;  ///< [m/s], [1/s], part; where and whereto is random.
  double imbalance = 0.0;                     ///< Imbalance of each rotor; relative.
  double accel_warming = 0.0, gyro_warming = 0.0;  ///< [m/s²], [rad/s]
  double sonar_loss = 0.0, sonar_double = 0.0;     ///< Not random.
  int decoys = 0;
  int people = 0;
};

/// The levels "none", "race" and "hard" of simulation.md. @throws std::invalid_argument for others.
[[nodiscard]] Randomize randomize_level(const std::string& level);

}  // namespace gatefly::world
