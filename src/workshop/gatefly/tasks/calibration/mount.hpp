// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"
#include "gatefly/files/labels_file.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sensing/camera.hpp"

namespace gatefly::calibration {

/// How the camera sits in the drone, as pictures of an upright square gate tell.
struct Mount {
  double tilt_down = 0.0, roll = 0.0;         ///< As camera_mount() has them [rad].
  double tilt_sigma = 0.0, roll_sigma = 0.0;  ///< One standard deviation.
  double rms_px = 0.0;                        ///< Misfit of all corners.
  std::size_t pictures = 0;
  // From a flight only:
  /// Of the logged heading against the position's axes [rad].
  double heading_offset = 0.0;
  double time_offset = 0.0;                        ///< Added to the pictures' times [s].
  Eigen::Vector3d p_EG = Eigen::Vector3d::Zero();  ///< The gate's centre [m].
};

/// From pictures that a level drone took of a gate standing upright: of all tilts, the one whose
/// upright square gates, anywhere and turned about the vertical, are drawn nearest to the corners.
///
/// A drone that stands askew shows as tilt and roll of the camera, degree for degree. sigma:
/// corners are taken to be off by 1 px, and alike in all pictures, as labels of similar pictures
/// are. A far gate's bars converge by less than that: give the height then.
/// @param gates  outer corners TL, TR, BR, BL in the upright picture [px]; at least 3 pictures.
/// @param height  of the gate's middle above the camera, known to 0.05 m [m]; nullopt: from its
///     perspective alone.
/// @throws std::runtime_error one line: too few, no gate fits them, or sigma above 3 degrees.
[[nodiscard]] Mount mount_from_level(std::span<const Quad> gates, const AnyCamera& lens,
                                     double gate_side, std::optional<double> height = std::nullopt);

/// From a recorded flight with labelled pictures of one gate, motion capture and attitude: pictures
/// taken in the air only (0.5 m above the start). The gate's place, the heading's offset and the
/// pictures' time offset are fitted too. sigma: the jackknife over pictures; an error of the logged
/// attitude that stays the same comes on top.
///
/// @param p_BC  the camera's place in the body frame [m].
/// @throws std::runtime_error one line: what the log or the labels lack.
[[nodiscard]] Mount mount_from_flight(const flight_log::FlightFolder& flight,
                                      const files::Labels& labels, const AnyCamera& lens,
                                      double gate_side, const Eigen::Vector3d& p_BC);

}  // namespace gatefly::calibration
