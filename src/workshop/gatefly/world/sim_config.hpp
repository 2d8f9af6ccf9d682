// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include <Eigen/Core>

#include "gatefly/sensing/camera.hpp"
#include "gatefly/world/faults.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::world {

/// The battery as a circuit: its voltage falls with its charge and with the current drawn.
struct Battery {
  double capacity = 4320.0;         ///< [C]; 1.2 Ah: Bebop 1.
  double full = 12.6, empty = 9.9;  ///< Open-circuit voltage, three cells [V].
  double resistance = 0.06;         ///< [Ohm; ours: 20 mOhm a cell]
  double hover_power = 70.0;        ///< [W; 11 minutes of hovering]
  double electronics = 5.0;         ///< [W]
};

/// The drone as it really is. The pilot's VehicleParams and drag are a team's idea of it.
struct VehicleTruth {
  double mass = 0.42;                               ///< [kg]
  Eigen::Vector3d inertia{0.0021, 0.0055, 0.0035};  ///< [kg m²]
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
  /// Moment of the air on rotors and frame per speed: a body that moves to the right is rolled left,
  /// one that moves forward is pitched up [N m/(m/s)]. [recorded flights]
  Eigen::Vector2d air_moment{0.002, 0.023};
  /// Thrust lost to the battery when it has hovered for `sag_time` (0..1); more under load.
  double sag = 0.0;
  double sag_time = 120.0;  ///< [s]
  Battery battery;
};

/// True behaviour of the sensors. Standard deviations [SI]; from recorded flights.
struct SensorTruth {
  Eigen::Vector3d accel_bias{0.08, -0.06, 0.3};    ///< At rest and in flight [m/s²].
  Eigen::Vector3d flight_bias{0, 0, 0};            ///< Vibration's share in flight [m/s²].
  Eigen::Vector3d gyro_bias{0.01, -0.008, 0.006};  ///< Constant, also at rest [rad/s].
  Eigen::Vector3d gyro_drift{0, 0, 0};             ///< Drift that begins at take-off [rad/s].
  Eigen::Vector3d accel_scale{1, 1, 1}, gyro_scale{1, 1, 1};
  Eigen::Vector3d accel_noise{0.38, 0.53, 0.90};  ///< White, of a sample at 512 Hz.
  /// RMS of the rotor-frequency part in flight.
  Eigen::Vector3d accel_vibration{1.55, 0.35, 3.4};
  Eigen::Vector3d gyro_noise{0.06, 0.06, 0.05};
  Eigen::Vector3d gyro_vibration{0.12, 0.11, 0.18};
  /// Rumble of the gyro at 3 to 20 Hz, no answer to a command: standard deviation of white
  /// noise through a band from 3 to 12 Hz, first order each [rad/s].
  Eigen::Vector3d gyro_rumble{0.160, 0.045, 0.146};
  /// Strength of each rotor's share of the vibration, 1 when all are balanced alike.
  Eigen::Vector4d imbalance{1, 1, 1, 1};
  /// Change of the biases while the IMU warms up [m/s²], [rad/s], [s].
  Eigen::Vector3d accel_warming{0, 0, 0}, gyro_warming{0, 0, 0};
  double warming_time = 90.0;
  double noise_scale = 1.0;
  double imu_hz = 512.0, sonar_hz = 20.0, baro_hz = 25.0;
  double imu_jitter = 3.0e-4;  ///< Jitter of the sampling interval [s].
  /// An autopilot hands its IMU on, so often, low-passed (0: raw), later by the jitter's size; 0: none
  /// does. [Betaflight: gyro 100-250 Hz, accelerometer 25 Hz; MSP 23-92 a second]
  double autopilot_imu_hz = 0.0;
  double autopilot_gyro_cutoff = 100.0, autopilot_accel_cutoff = 25.0;  ///< [Hz]
  double autopilot_imu_jitter = 0.003;                                  ///< [s]
  double sonar_noise = 0.015;                                           ///< [m]
  double sonar_max = 5.0;                                               ///< [m]
  double sonar_loss = 0.0;    ///< Part of the echoes that never come back.
  double sonar_double = 0.0;  ///< Part of them that come by way of the drone's belly: twice as far.
  double baro_noise = 0.15;   ///< [m]
  double baro_drift = 0.10;   ///< Random walk [m/√(10 s)].
  double baro_airspeed = 0.3;  ///< Part of the dynamic pressure that it takes for height.
  double camera_hz = 15.0;
  double camera_latency = 0.030;  ///< From the end of read-out to arrival [s].
  double latency_jitter = 0.0;    ///< [s]
  double frame_loss = 0.0;        ///< Part of the frames that never arrives.
};

/// An autopilot between the pilot and the rotors, set as its owner has it. [Betaflight 4.4 as a team of
/// the AI Grand Prix flew it]
struct AutopilotTruth {
  enum class Takes { kNone, kAngles, kRates };
  Takes takes = Takes::kNone;              ///< kNone: the pilot turns the rotors itself.
  double hz = 40.0;                        ///< Set points a second.
  double delay = 0.020;                    ///< Least time until each has arrived [s].
  double delay_jitter = 0.010;             ///< And so much more, half normal [s].
  double smoothing_hz = 15.0;              ///< Low-pass of third order of the set points; 0: none.
  double gain = 1.0;                       ///< Its rate loop / that of one well tuned.
  double angle_gain = 5.0;                 ///< Rate for an angle's error [1/s].
  double most_angle = 1.0471975511965976;  ///< With the stick at its end [rad].
  Eigen::Vector3d rc_rate{55.0, 55.0, 57.0};  ///< Roll, pitch, yaw, in Betaflight's numbers ...
  Eigen::Vector3d super_rate{75.0, 75.0, 70.0}, rc_expo{0.0, 0.0, 0.0};  ///< ... [%].
  int throttle_mid = 54, throttle_expo = 68;                             ///< [%]
};

/// Effects of optics and image processing on colour and sharpness. [real pictures;
/// docs/simulation.md]
struct Imaging {
  double footprint_px = 0.8;  ///< Side of the square of light that a pixel gathers.
  double red_shift_px = 0.6;  ///< How far red lies above green and blue: fringes.
  int chroma_smoothing = 1;   ///< Passes of [1 2 1]/4 along upright lines.
  double saturation = 1.25;   ///< Saturation after the colour matrix.
};

/// The camera as it really is (the pilot's calibration is a little wrong). Bebop's values.
struct CameraTruth {
  AnyCamera lens;                        ///< Upright picture, 315 x 160.
  Eigen::Vector3d p_BC{0.10, 0.0, 0.0};  ///< Focal point in the body frame [m].
  double tilt_down = 0.349066;           ///< [rad]
  /// Turned by 90°: a stored line is an upright column.
  int stored_width = 160, stored_height = 315;
  int stored_rotation = 90;  ///< Counter-clockwise turn that makes it upright [deg].
  /// Quality of the JPEG, 4:2:0, that a picture goes through before delivery; 0: none.
  int jpeg_quality = 0;
  double exposure = 0.008;  ///< Nominal longest; each line is exposed that long [s].
  double readout = 0.020;   ///< From the first to the last stored line [s].
  bool fast = false;        ///< One ray a pixel: no motion blur, no softness, no bloom, no glare.
  Imaging imaging;

  /// Width of the upright picture.
  [[nodiscard]] int width() const {
    return stored_rotation % 180 == 0 ? stored_width : stored_height;
  }
  [[nodiscard]] int height() const {
    return stored_rotation % 180 == 0 ? stored_height : stored_width;
  }
  /// Place in the upright picture of a place in the stored one.
  [[nodiscard]] Eigen::Vector2d upright(double x, double line) const {
    switch (stored_rotation) {
      case 90:
        return {line, stored_width - 1 - x};
      case 180:
        return {stored_width - 1 - x, stored_height - 1 - line};
      case 270:
        return {stored_height - 1 - line, x};
      default:
        return {x, line};
    }
  }
  /// The stored line of an upright place: lines are exposed one after the other.
  [[nodiscard]] double line_of(const Eigen::Vector2d& px) const {
    switch (stored_rotation) {
      case 90:
        return px.x();
      case 180:
        return stored_height - 1 - px.y();
      case 270:
        return stored_height - 1 - px.x();
      default:
        return px.y();
    }
  }
  /// Part of the read-out after which that line begins, 0..1.
  [[nodiscard]] double part_of_readout(const Eigen::Vector2d& px) const {
    const double last = stored_height - 1;
    return last > 0.0 ? std::clamp(line_of(px) / last, 0.0, 1.0) : 0.0;
  }
};

/// Draws of a seed for the light and the sensor's handling of it.
struct LightConditions {
  static constexpr int kGroups = 3;  ///< e.g. ceiling, showcases, windows
  /// Relative brightness of each light group.
  std::array<double, kGroups> group_gain{1, 1, 1};
  /// And their colours: gains r, g, b.
  std::array<std::array<double, 3>, kGroups> group_color{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  /// Amount of light the exposure aims at, relative to nominal.
  double exposure_target = 1.0;
  std::array<double, 3> white_balance{1, 1, 1};  ///< Gains r, g, b.
  double noise_scale = 1.0;
  During out{0, 0};   ///< When all lamps are down to a fiftieth.
  double blur = 1.0;  ///< Side of what a pixel sees, relative to nominal: above 1 is less sharp.
  /// Not 0: walls, floor and clutter have other albedos and patterns, drawn by this seed.
  std::uint64_t surfaces = 0;
};

/// How detections are drawn when no pictures are rendered.
struct IdealVisionParams {
  std::string detector = "ours";  ///< Statistics of "ours" or "paper".
  /// Part of the whole gates that are outliers: seen as from a place up to 3 m away.
  double outliers = 0.0;
  double false_alarms = 1.0;  ///< Times as many as the detector has.
};

/// Start pose on the pad.
struct StartTruth {
  Eigen::Vector2d position{0, 0};  ///< [m]
  double heading = 0.0;            ///< [rad]
};

/// Air from a door, an opening or a fan: a straight jet that stays where it is, the same all along
/// and at every height.
struct Jet {
  Eigen::Vector2d through{0, 0};  ///< A place on its axis [m].
  double heading = 0.0;           ///< It blows that way [rad].
  double speed = 0.0;             ///< On its axis [m/s].
  double width = 1.0;             ///< Between the places where half of that blows [m].
};

/// Horizontal air that moves one way and is the faster the farther aside: with the heading to the
/// right of the middle, against it to the left, not at all in between.
struct Shear {
  Eigen::Vector2d middle{0, 0};  ///< [m]
  double heading = 0.0;          ///< [rad]
  double rate = 0.0;             ///< Speed for each metre aside [1/s].
};

/// Moving air: a mean, Dryden's gusts (MIL-F-8785C), and what buildings add. [docs/simulation.md]
struct Wind {
  Eigen::Vector2d mean{0, 0};  ///< Towards north, east [m/s].
  double gust = 0.0;           ///< Standard deviation of each horizontal axis [m/s].
  double gust_length = 1.7;    ///< Length of gusts along and across [m; ours, estimate: a hall].
  double gust_vertical = 0.5;  ///< Vertical / horizontal standard deviation [estimate].
  Jet jet{};
  Shear shear{};
  double wash = 0.0;  ///< Part of the nominal wash that comes back from walls.
};

/// Everything the simulator needs, already drawn for one seed.
struct SimConfig {
  World world;
  VehicleTruth vehicle;
  SensorTruth sensors;
  AutopilotTruth autopilot;
  CameraTruth camera;
  LightConditions light;
  IdealVisionParams ideal_vision;  ///< Used when no pictures are rendered.
  StartTruth start;
  Wind wind;
  Faults faults;  ///< Those with a time; the others have changed the truth above.
  std::uint64_t seed = 1;
  std::filesystem::path cache_dir = ".cache/gatefly";
  int bake_threads = 2;
};

}  // namespace gatefly::world
