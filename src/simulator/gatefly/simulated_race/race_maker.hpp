// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/config/track_file.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"
#include "gatefly/simulated_race/results/summary.hpp"
#include "gatefly/tasks/arguments.hpp"

namespace gatefly::simulated_race {

/// Arguments of a race, but its seed.
struct RaceArguments {
  tasks::ConfigArguments config;
  std::string track = "showroom";   ///< A name in tracks/ or a file.
  std::string vision = "rendered";  ///< Or "ideal".
  std::optional<int> laps;          ///< Instead of the track's own number.
};

/// The pilot's half comes from configuration and map, the simulator's from the same and the seed.
/// Nothing drawn goes to the pilot.
struct Race {
  RaceConfig config;
  RaceIdentity identity;
};

/// Reads track and configuration once, then makes the race of any seed.
class RaceMaker {
 public:
  /// @throws std::runtime_error one line: unreadable, not allowed, or a course that cannot be
  ///     flown.
  explicit RaceMaker(const RaceArguments& given);
  /// Maker from the track and configuration in a flight's folder.
  [[nodiscard]] static RaceMaker of_flight(const std::filesystem::path& directory);

  [[nodiscard]] Race race(std::uint64_t seed) const;

  /// Files that replay will need, by name: tasks/flight_inputs.hpp.
  [[nodiscard]] const std::map<std::string, std::string>& inputs() const { return inputs_; }
  /// Remarks of the configuration to its user.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  RaceMaker() = default;
  void nominal(const config::Config& config, const std::filesystem::path& path,
               config::TrackFile file, const std::string& vision);

  RaceConfig nominal_;
  world::Randomize randomize_;
  RaceIdentity identity_;
  std::map<std::string, std::string> inputs_;
  std::vector<std::string> notes_;
};

}  // namespace gatefly::simulated_race
