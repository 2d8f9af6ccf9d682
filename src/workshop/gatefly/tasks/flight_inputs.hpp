// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/tasks/arguments.hpp"

// A flight's inputs lie in its folder: `fly` puts them there, `replay` takes them from there.
namespace gatefly::tasks {

/// Files of the folder by name: track and configurations as given, a fitted colour table, settings.
/// @param config  what `options` load as.
[[nodiscard]] std::map<std::string, std::string> flight_inputs(const ConfigArguments& options,
                                                               const config::Config& config,
                                                               const std::filesystem::path& track,
                                                               int laps);

/// Whether `gatefly fly` flew it, by what is in its folder.
[[nodiscard]] bool is_simulated(const std::filesystem::path& directory);

/// @throws std::runtime_error one line: what fly wrote is not all there, or it has no pictures.
void expect_whole(const std::filesystem::path& directory, const flight_log::FlightFolder& folder);

/// The configuration a flight was flown with, then the user's.
[[nodiscard]] config::Config config_of_flight(const std::filesystem::path& directory,
                                              const ConfigArguments& user);

/// nullopt where its settings do not say.
[[nodiscard]] std::optional<int> laps_of_flight(const std::filesystem::path& directory);

/// Its seed. @throws std::runtime_error one line, when summary.json does not say it.
[[nodiscard]] std::uint64_t seed_of_flight(const std::filesystem::path& directory);

/// Its gates as they stood, by summary.json; empty where that does not say.
[[nodiscard]] std::vector<MapGate> true_gates_of_flight(const std::filesystem::path& directory);

/// Version of gatefly that flew it; "" where its summary does not say.
[[nodiscard]] std::string version_of_flight(const std::filesystem::path& directory);

/// "control.speed_mps is 1.2, was 1.5 in flight" for the first key that summary.json has otherwise;
/// "" when none.
[[nodiscard]] std::string difference_in(const config::Config& config,
                                        const std::filesystem::path& directory);

}  // namespace gatefly::tasks
