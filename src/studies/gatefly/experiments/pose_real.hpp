// SPDX-License-Identifier: Apache-2.0
#pragma once

// Shared by the two halves of pose-real; see pose_real.cpp.
#include <string>

#include "gatefly/config/config.hpp"
#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/sensing/camera.hpp"
#include "gatefly/tasks/calibration/calibration.hpp"

namespace gatefly::experiments::pose_real_parts {

inline constexpr double kLabelSigmaPx = 1.5;  ///< Corners clicked twice differ by 2.8 px (median).
/// Labels and detections are the corners of the bars' middle lines. By motion capture that square
/// has 1.0 m (flight_11).
inline constexpr double kSide = 1.0;
/// Corners of the upright picture.
inline constexpr const char* kCorners = "calib_rot_3_corners.csv";
/// Corners of another day, as stored.
inline constexpr const char* kOtherCorners = "calib_Flow_3c_corners.csv";

/// The camera's mount is the airframe's; the lens comes from the calibration.
[[nodiscard]] config::Config config_with(const std::string& name);

/// As `gatefly calibrate` has it. @param rotation_deg  how the listed pictures are stored.
[[nodiscard]] calibration::Calibration calibrated(const char* corners, int rotation_deg,
                                                  const Options& options);

[[nodiscard]] AnyCamera lens_of(const calibration::ModelResult& result);

/// distance51: distances to a gate that somebody measured with a tape. Adds to the result; returns
/// what to draw.
[[nodiscard]] drawing::Plot report_distances(const Options& options,
                                             const calibration::Calibration& camera,
                                             Result& result);

/// flight_11 against motion capture. Adds to the result; returns what to draw.
[[nodiscard]] drawing::Plot report_flight(const Options& options,
                                          const calibration::Calibration& camera, Result& result);

}  // namespace gatefly::experiments::pose_real_parts
