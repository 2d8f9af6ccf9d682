// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/flight_log/replay.hpp"

// Trajectories as the TUM RGB-D benchmark writes them, for evo and other tools:
// `timestamp tx ty tz qx qy qz qw`, one line an IMU sample. Axes are the log's: north, east, down; body forward, right, down.
namespace gatefly::tasks {

[[nodiscard]] std::string tum_of_estimates(const flight_log::ReplayResult& result);

/// The true motion, where the log has it.
struct TumTruth {
  std::string text;
  bool has_attitude = false;  ///< Else each is the identity, 0 0 0 1.
};
/// nullopt when the log has no true position.
[[nodiscard]] std::optional<TumTruth> tum_of_truth(const flight_log::FlightFolder& flight);

/// Beside est.txt: est.truth.txt.
[[nodiscard]] std::filesystem::path tum_truth_path(const std::filesystem::path& estimates);

}  // namespace gatefly::tasks
