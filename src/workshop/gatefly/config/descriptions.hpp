// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/control/indi.hpp"
#include "gatefly/detection/color_model.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sensing/camera.hpp"

// Quantities that a team measures: the pilot takes them as they are, the simulator varies them.
// Sources of the defaults: config_keys.cpp.
namespace gatefly::config {

/// [camera]: the camera, how it is mounted and how late it is.
struct CameraDescription {
  std::string model = "dhane";
  int width = 315, height = 160;  ///< Size of the upright picture [px].
  Eigen::Vector2d focal_px = DhaneFisheye{}.focal_px, center_px = DhaneFisheye{}.center_px;
  std::vector<double> distortion{DhaneFisheye{}.k};  ///< The model's coefficients, in its order.
  int stored_rotation_deg = 90;  ///< Counter-clockwise turn that makes a stored picture upright.
  double tilt_down = 20.0 * kDegree;
  Eigen::Vector3d p_BC{0.10, 0.0, 0.0};  ///< Focal point in the body frame [m].
  double latency = 0.030;                ///< From the end of read-out to arrival [s].
  double readout = 0.020;                ///< First to last stored line [s].
  double exposure = 0.008;               ///< Longest, of each line [s].
  double rate_hz = 15.0;
  int jpeg_quality = 0;  ///< Quality of the simulated camera's JPEG, 4:2:0; 0: none.

  [[nodiscard]] int stored_width() const { return stored_rotation_deg % 180 == 0 ? width : height; }
  [[nodiscard]] int stored_height() const {
    return stored_rotation_deg % 180 == 0 ? height : width;
  }
};

/// [vehicle]: all of it, and nothing else, is what attitude control is told.
using VehicleDescription = VehicleParams;

/// [vehicle]: how often its sensors speak.
struct SensorRates {
  double imu_hz = 512.0, sonar_hz = 20.0, baro_hz = 25.0;
  double filter_imu_hz = 0.0;               ///< IMU rate of the estimator, if another.
  std::string sonar = "yes", baro = "yes";  ///< "none": the pilot has to do without.
};

/// [gate] and [color]: a gate where no file says otherwise.
struct GateDescription {
  double side = 1.0, bar = 0.05;       ///< [m]
  std::string corners = "outer";       ///< Meaning of labels and detections.
  Eigen::Vector3d rgb{1.0, 0.4, 0.0};  ///< Colour of its paint, sRGB 0..1; its hue counts.
  /// File of a fitted colour model, in place of rgb; "": none. From the working directory.
  std::string color_table;
  std::optional<ColorModel> fitted_color;  ///< Contents of that file.
};

}  // namespace gatefly::config
