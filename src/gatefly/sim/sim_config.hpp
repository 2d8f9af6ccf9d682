// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include <Eigen/Core>

#include "gatefly/sim/camera.hpp"
#include "gatefly/sim/ideal_vision_params.hpp"
#include "gatefly/sim/world.hpp"

namespace gatefly::sim {

/// The drone as it really is. The pilot's VehicleParams and drag are a team's idea of it.
struct VehicleTruth {
  double mass = 0.42;                               ///< [kg]
  Eigen::Vector3d inertia{0.0021, 0.0020, 0.0035};  ///< [kg m²]
  /// With propeller guards [m]. [docs/simulation.md]
  Eigen::Vector3d size{0.38, 0.33, 0.09};
  double arm_x = 0.112, arm_y = 0.095;         ///< Rotor distance from the centre [m].
  double propeller_radius = 0.065;             ///< [m]
  double thrust_coefficient = 1.72e-6;         ///< [N/(rad/s)²]
  double torque_coefficient = 0.016;           ///< [m]
  double rotor_time_constant = 0.020;          ///< [s]
  double min_speed = 0.0, max_speed = 1250.0;  ///< [rad/s]
  /// At hover, grows with rotor speed [1/s]. [recorded flights]
  Eigen::Vector3d rotor_drag{-0.50, -0.44, -0.15};
  /// Quadratic part [1/m]. [ours: makes k speed-dependent]
  double body_drag = 0.022;
  /// Thrust lost to the battery by `sag_time` (0..1).
  double sag = 0.0;
  double sag_time = 120.0;  ///< [s]
};

/// What the sensors really do. Standard deviations [SI]; from recorded flights.
struct SensorTruth {
  Eigen::Vector3d accel_bias{0.08, -0.06, 0.3};    ///< At rest and in flight [m/s²].
  Eigen::Vector3d flight_bias{0, 0, 0};            ///< What vibration adds in flight [m/s²].
  Eigen::Vector3d gyro_bias{0.01, -0.008, 0.006};  ///< Constant, also at rest [rad/s].
  Eigen::Vector3d gyro_drift{0, 0, 0};             ///< What appears after take-off [rad/s].
  Eigen::Vector3d accel_scale{1, 1, 1}, gyro_scale{1, 1, 1};
  Eigen::Vector3d accel_noise{0.50, 0.45, 0.90};  ///< White at 512 Hz.
  /// RMS of the rotor-frequency part in flight.
  Eigen::Vector3d accel_vibration{1.7, 0.6, 3.4};
  Eigen::Vector3d gyro_noise{0.06, 0.06, 0.05};
  Eigen::Vector3d gyro_vibration{0.12, 0.11, 0.18};
  double noise_scale = 1.0;
  double imu_jitter = 3.0e-4;  ///< Of the sampling interval [s].
  double sonar_noise = 0.015;  ///< [m]
  double sonar_max = 5.0;      ///< [m]
  double baro_noise = 0.15;    ///< [m]
  double baro_drift = 0.10;    ///< Random walk [m/√(10 s)].
  double camera_hz = 15.0;
  double camera_latency = 0.030;  ///< From the end of read-out to arrival [s].
  double latency_jitter = 0.0;    ///< [s]
  double frame_loss = 0.0;        ///< Part of the frames that never arrives.
};

/// Start pose on the pad.
struct StartTruth {
  Eigen::Vector2d position{0, 0};  ///< [m]
  double heading = 0.0;            ///< [rad]
};

struct Wind {
  Eigen::Vector2d mean{0, 0};  ///< [m/s]
  double gust = 0.0;           ///< Standard deviation, 1 s correlation [m/s].
};

/// Everything the simulator needs, already drawn for one seed.
struct SimConfig {
  World world;
  VehicleTruth vehicle;
  SensorTruth sensors;
  CameraTruth camera;
  LightConditions light;
  IdealVisionParams ideal_vision;  ///< Used when no pictures are rendered.
  StartTruth start;
  Wind wind;
  std::uint64_t seed = 1;
  std::filesystem::path cache_dir = ".cache/gatefly";
  int bake_threads = 2;
};

/// Sizes of what one day varies: one standard deviation each, drawn cut at 2.5 σ.
/// [docs/simulation.md]
struct Randomize {
  double gate_position = 0.0, gate_heading = 0.0, gate_height = 0.0;  ///< [m], [rad], [m]
  double start_position = 0.0, start_heading = 0.0;                   ///< [m], [rad]
  double camera_focal = 0.0, camera_center_px = 0.0, camera_k = 0.0, camera_tilt = 0.0,
         camera_latency = 0.0;
  double gate_side = 0.0;                                  ///< Relative.
  double drag = 0.0, mass = 0.0, thrust = 0.0, sag = 0.0;  ///< Relative; sag is not random.
  double accel_bias = 0.0, gyro_bias = 0.0, scale = 0.0;   ///< [m/s²], [rad/s], relative
  /// [m/s²] [ours: rectified vibration]
  double flight_bias = 0.0;
  double noise_scale = 1.0;
  double light = 0.0, exposure = 0.0, hue = 0.0, white_balance = 0.0;  ///< Relative; hue [rad].
  double frame_loss = 0.0, latency_jitter = 0.0;
  double wind = 0.0, gust = 0.0;  ///< [m/s]
  int decoys = 0;
};

/// The levels "none", "race" and "hard" of simulation.md. @throws std::invalid_argument for others.
[[nodiscard]] Randomize randomize_level(const std::string& level);

/// One seed's truth around the nominal one. The pilot keeps the nominal.
[[nodiscard]] SimConfig drawn(const SimConfig& nominal, const Randomize& sigma, std::uint64_t seed);

}  // namespace gatefly::sim
