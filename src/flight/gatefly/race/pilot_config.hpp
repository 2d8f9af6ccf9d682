// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/control/control_params.hpp"
#include "gatefly/detection/color_model.hpp"
#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/pose/gate_fix.hpp"
#include "gatefly/race/path.hpp"
#include "gatefly/race/phase.hpp"
#include "gatefly/race/race_params.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly {

/// Method: ours or the paper's.
enum class Scheme { kOurs, kPaper };

/// The filter that flies.
enum class FilterModel {
  kDrag,   ///< Li18's drag filter as we use it: takes air speed for ground speed.
  kPaper,  ///< The same as Li18 uses it. [estimation/drag_filter_use.hpp]
  kOurs,   ///< The error-state filter: wind, gates, mount and delay are states.
};

/// Everything that a pilot is given before take-off. Start-up only.
struct PilotConfig {
  /// The method of each box; any mixture can be configured.
  DetectorMode detector_mode = DetectorMode::kOurs;
  Scheme pose_scheme = Scheme::kOurs;
  FilterModel filter_model = FilterModel::kDrag;
  Scheme control_scheme = Scheme::kOurs;
  Track track;
  CameraRig camera;
  CameraTiming camera_timing;
  ColorModel gate_color = ColorModel::described({1.0, 0.4, 0.0});
  GateDetectorParams detector;
  PoseParams pose;
  SightParams sight;
  AhrsParams ahrs;
  DragFilterParams filter;
  PaperFilterParams paper_filter;
  eskf::Params error_state;  ///< For FilterModel::kOurs; what else is known stands below.
  VelocityObserverParams velocity;
  AltimeterParams altimeter;
  LateralParams lateral;
  AltitudeParams altitude;
  SpeedParams speed;
  LookAsideParams look_aside;
  PaperControlParams paper_control;
  HoldParams hold;
  Output output = Output::kMotors;
  RateParams rates;  ///< Used when the output goes to an autopilot.
  IndiParams indi;
  VehicleParams vehicle;
  PlanParams plan;
  CourseParams course;
  PhaseParams
      phase;  ///< Its rest_samples are of an IMU at 512 Hz: the rest lasts as long at any rate.
  double imu_hz = 512.0;  ///< Nominal rate of the IMU. [Li18 flight code]
  /// Nominal rate of Sensors::navigation_imu, which kOurs estimates by then; 0: by Sensors::imu.
  double filter_imu_hz = 0.0;
  bool uses_sonar = true, uses_baro = true;  ///< False: absent, or not to be trusted.
  double filter_memory = 0.25;  ///< So late a picture may come [s]. [ours: twice a Bebop's latency]
  double map_sigma = 0.12;      ///< How well gates are known relative to each other [m]. [estimate]
  double gate_height_sigma =
      0.05;  ///< Standard deviation of a gate centre's height [m]. [docs/simulation.md]
  double gate_yaw_sigma = 0.06;  ///< And how well their headings are [rad]. [estimate]
};

}  // namespace gatefly
