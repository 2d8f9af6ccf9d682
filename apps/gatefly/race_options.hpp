// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "gatefly/closed_loop/race.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/report/summary.hpp"

#include "commands.hpp"

namespace gatefly::cli {

/// What `fly` and `campaign` are told about a race, but its seed.
struct RaceOptions {
  CommonOptions common;
  std::string track = "showroom", vision = "rendered";
  std::optional<int> laps;
};

/// --laps, --vision and the flags that every subcommand has.
void add_race_options(Command& command, RaceOptions& options);

/// The pilot's half comes from configuration and map, the simulator's from the same and the seed.
/// Nothing drawn goes to the pilot.
struct Race {
  closed_loop::RaceConfig config;
  io::RaceIdentity identity;
};

/// Reads track and configuration once, then makes the race of any seed.
class RaceMaker {
 public:
  /// @throws std::runtime_error one line: unreadable, not allowed, or a course that cannot be
  ///     flown.
  explicit RaceMaker(const RaceOptions& options);

  [[nodiscard]] Race race(std::uint64_t seed) const;

  /// What replay will need, by file name: flight_inputs.hpp.
  [[nodiscard]] const std::map<std::string, std::string>& inputs() const { return inputs_; }

 private:
  closed_loop::RaceConfig nominal_;
  sim::Randomize randomize_;
  io::RaceIdentity identity_;
  std::map<std::string, std::string> inputs_;
};

/// "gatefly fly TRACK --seed N ..." that flies one of these races alone.
[[nodiscard]] std::string fly_command(const RaceOptions& options, const std::string& seed);

}  // namespace gatefly::cli
