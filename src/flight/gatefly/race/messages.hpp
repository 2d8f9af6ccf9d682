// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <optional>

#include <Eigen/Core>

#include "gatefly/control/attitude_command.hpp"
#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sensing/image.hpp"
#include "gatefly/sensing/imu.hpp"

// Inputs, outputs and readable state of a pilot.

namespace gatefly {

/// Detections made elsewhere, in place of a picture: the simulator's ideal vision.
struct SeenGates {
  GateDetections gates;  ///< Best first.
  std::optional<LowerCorners> lower_corners =
      std::nullopt;                             ///< Its upper bar is above the picture.
  std::optional<GateBars> bars = std::nullopt;  ///< One too near to be whole.
  /// One that the border cuts: a corner of fitness 0 is not in view.
  std::optional<GateDetection> cut = std::nullopt;
  int image_width = 315, image_height = 160;  ///< Size of the upright picture [px].
};

/// Measurements of one tick. All but the IMU are slower and absent in most ticks.
struct Sensors {
  std::chrono::nanoseconds time{0};  ///< Stamp of the IMU sample; must not run backwards.
  Imu imu;
  /// The estimator's sample in place of `imu`, where PilotConfig::filter_imu_hz says so: an
  /// autopilot's, filtered by it, of just now; arrives in some ticks only.
  std::optional<Imu> navigation_imu = std::nullopt;
  std::optional<double> sonar = std::nullopt;  ///< Range to what is below, along body z [m].
  std::optional<double> baro = std::nullopt;   ///< Height above the pad [m].
  /// Arrived now, exposed `latency` and `picture_late` ago; read in this call only.
  std::optional<Image> image = std::nullopt;
  std::optional<SeenGates> seen = std::nullopt;  ///< Instead of an image, and as late.
  /// Either came so much later than `latency` says, by the picture's stamp [s]; 0 also where it has
  /// none. The paper's pilot does not ask: to it a fix is of now.
  double picture_late = 0.0;
  /// Another pilot flies, as in the replay of a log: this one's commands do not reach the rotors ...
  bool looks_on = false;
  bool lifted = false;  ///< ... that one has taken off: the rest is over ...
  /// ... and what it commanded, if that is known; see Command::motors.
  std::optional<std::array<double, 4>> motors = std::nullopt;
};

/// Set points for the drone until the next tick.
struct Command {
  AttitudeCommand attitude;
  /// Rotor speeds [rad/s]: left front, right front, right back, left back. For an autopilot they are
  /// alike, those at which the rotors give the thrust; all 0: motors off.
  std::array<double, 4> motors{};
  /// For an autopilot: turn rates that bring the attitude there [rad/s]; else 0.
  Eigen::Vector3d rates_B = Eigen::Vector3d::Zero();
};

/// The pilot's belief, for logs, displays and tests; only the pilot itself flies by it.
struct Estimate {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d v_E = Eigen::Vector3d::Zero();   ///< [m/s]
  Attitude attitude;
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< [rad/s]
  /// The position in the frame of the target gate [m] ...
  Eigen::Vector3d p_GB = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_GB = Eigen::Matrix3d::Identity();  ///< ... and its covariance [m²].
  int gates_passed = 0;
};

/// The fix that corrected the filter, in earth axes, for another filter to use.
struct FixOnCourse {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();  ///< Position now, not at the exposure [m].
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< [m²]; earth axes.
  bool has_height = true;
  std::optional<double> yaw = std::nullopt;  ///< Heading the gate tells [rad] ...
  double yaw_sigma = 0.0;                    ///< ... and how well.
};

/// Result of the last picture: detections, and whether one corrected the filter.
struct Sighting {
  enum class Source { kNone, kCorners, kBars };  ///< kCorners: four, or what the border leaves.
  bool seen = false;                             ///< At least one gate was detected.
  bool careful = false;                          ///< The picture was searched carefully.
  /// The target should be in it, whole, and so near and straight that it is hardly ever missed for long.
  bool expected = false;
  /// One of them, or a part, gave a fix of the target; the filter may have refused it.
  bool offered = false;
  GateDetections detections;      ///< Best first; the one that was used is `used`.
  int used = -1;                  ///< Index into detections; -1 when none (or bars).
  Source source = Source::kNone;  ///< Kind of fix of the target that corrected the filter.
  /// Corners of a gate, the target or another, corrected the height; side bars do not tell it.
  bool tells_height = false;
  std::optional<FixOnCourse> fix;
  /// Normalised innovation squared of that fix ...
  double nis = 0.0;
  int nis_dof = 0;  ///< ... and its degrees of freedom; 0: nothing corrected.
  std::optional<GateBars> bars;
  std::optional<LowerCorners> lower_corners;  ///< Looked for when no whole gate was of use.
};

}  // namespace gatefly
