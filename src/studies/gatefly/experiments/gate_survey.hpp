// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"
#include "gatefly/experiments/logged_motion.hpp"
#include "gatefly/pose/gate_fix.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly::experiments {

/// Place of a gate in motion capture's frame, upright.
struct SurveyedGate {
  Eigen::Vector3d p_EG = Eigen::Vector3d::Zero();  ///< [m]
  double yaw = 0.0;                                ///< [rad]
};

/// Parameters that all flights of an airframe share.
struct Airframe {
  double camera_roll = 0.0;       ///< As camera_mount() has it [rad].
  double exposure_delay = 0.030;  ///< From the middle of the exposure to the picture's stamp [s].
  double mocap_delay = 0.020;     ///< From a position to its row in the log [s].
};

/// Parameters that differ from flight to flight.
struct FlightSetup {
  double heading = 0.0;  ///< Added to the attitudes' yaw [rad].
  double tilt = 0.0;     ///< Tilt of the camera, down [rad].
};

/// A gate in one picture.
struct GatePicture {
  double t = 0.0;  ///< The picture's stamp [s].
  Quad px{};       ///< Corners, clockwise from top-left.
};

/// A flight to one gate.
struct SurveyFlight {
  const LoggedMotion* motion = nullptr;
  std::vector<GatePicture> pictures;
  std::size_t gate = 0;  ///< Which of Survey::gates.
};

struct Survey {
  Airframe airframe;
  std::vector<SurveyedGate> gates;
  std::vector<FlightSetup> flights;
};

/// The camera of a drone that is measured so.
[[nodiscard]] CameraRig mounted(CameraRig lens, const Airframe& airframe,
                                const FlightSetup& flight);

/// When the line of the picture that shows a gate's middle was exposed [s].
[[nodiscard]] double exposed_at(const GatePicture& picture, const Airframe& airframe,
                                const PilotConfig& pilot);

/// Distances between the corners that a survey expects in a picture and those that were seen, RMS
/// [px].
[[nodiscard]] double misfit_px(const Survey& survey, std::size_t flight, const SurveyFlight& seen,
                               const GatePicture& picture, const PilotConfig& pilot);

/// Parameters left open in a fit.
enum class Open {
  kAll,  ///< Airframe, gates, flights.
  kNotAirframe,
  kFlights,  ///< Heading and tilt of each flight alone.
};

/// Least squares over the corners of all pictures, outliers weighing less (soft L1 from 2 px).
/// @param pilot  lens and place of the camera, its read-out, the side of the map's first gate.
[[nodiscard]] Survey surveyed(std::span<const SurveyFlight> flights, const Survey& start, Open open,
                              const PilotConfig& pilot);

}  // namespace gatefly::experiments
