// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "gatefly/tasks/arguments.hpp"

#include "command_line.hpp"

namespace gatefly::cli {

/// Which drone: short for --config and --set.
struct DroneOptions {
  std::string camera, vehicle;
  std::optional<double> speed;  ///< [m/s]
};

/// --camera and --vehicle.
void add_drone(Command& command, DroneOptions& options);
/// --speed, of those that fly.
void add_speed(Command& command, DroneOptions& options);

/// Puts camera and vehicle behind the --config files, and the speed behind the --set.
/// @throws std::runtime_error one line: not there, no such file, two speeds.
void take_drone(const DroneOptions& drone, tasks::ConfigArguments& config);

}  // namespace gatefly::cli
