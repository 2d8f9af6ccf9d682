// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "gatefly/race/pilot.hpp"

namespace gatefly::flight_log {

/// True state at one moment. The pilot never sees this.
struct Truth {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero(), v_E = Eigen::Vector3d::Zero();
  Attitude attitude;
  Eigen::Vector2d wind_E = Eigen::Vector2d::Zero();  ///< The air's speed, north and east [m/s].
  std::optional<double> battery_v = std::nullopt;    ///< Under the present load [V].
};

/// One IMU tick of a race, for recording: what went in, what came out, what was.
struct Tick {
  const Sensors& sensors;
  const Command& command;
  const Pilot& pilot;
  Truth truth;
  std::span<const std::uint8_t> frame;  ///< Raw UYVY of sensors.image; empty when there is none.
  /// When what the pilot sees now began its exposure [s].
  std::optional<double> exposed = std::nullopt;
  /// Wall-clock of the pilot's step [s]; not the same in two flights of one seed.
  std::optional<double> took = std::nullopt;
  /// True corners of the next gate in what the pilot sees now [px, upright]; nothing
  /// unless it shows the gate whole and unhidden.
  std::optional<Quad> next_gate_px = std::nullopt;
};

}  // namespace gatefly::flight_log
