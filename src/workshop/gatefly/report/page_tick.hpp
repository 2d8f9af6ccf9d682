// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly::report {

/// One tick of a flight. What nobody knows is empty.
struct PageTick {
  const Sensors& sensors;
  const Command& command;
  const Pilot& pilot;
  const Estimate* estimate = nullptr;  ///< Another filter's; nullptr: the pilot's.
  std::optional<Eigen::Vector3d> p_EB = std::nullopt, v_E = std::nullopt;  ///< Truth.
  std::optional<Attitude> attitude = std::nullopt;
  std::optional<Eigen::Vector2d> wind_E = std::nullopt;
  std::optional<double> exposed = std::nullopt;  ///< Begin of the picture's exposure [s].
  std::optional<double> battery_v = std::nullopt;
  std::optional<double> took = std::nullopt;  ///< Wall-clock of the pilot's step [s].
};

}  // namespace gatefly::report
