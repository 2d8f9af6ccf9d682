// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gatefly/experiments/attitude_errors.hpp"
#include "gatefly/flight_log/flight_folder.hpp"

namespace gatefly::experiments {

/// Roll and pitch over a real flight beside motion capture's: ours, Mahony's, the autopilot's own.
struct FlownAttitude {
  std::string name;
  AttitudeDifferences ours, mahony, authors;
  double reference_sigma_deg = 0.0;
  AttitudeTrace trace;
};

/// Tilt by motion capture's positions: an inertial filter that is given all of them.
/// @param heading_offset  of the logged heading against the positions' axes [rad].
[[nodiscard]] FlownAttitude flown_attitude(const std::string& name,
                                           const flight_log::FlightFolder& flight,
                                           double heading_offset);

}  // namespace gatefly::experiments
