// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "gatefly/simulated_race/race_maker.hpp"

#include "commands.hpp"
#include "drone_options.hpp"

namespace gatefly::cli {

/// Options of a race that `fly` and `campaign` share; all but the seed.
struct RaceOptions {
  CommonOptions common;
  DroneOptions drone;
  std::string track = "showroom", vision = "rendered";
  std::optional<int> laps;
};

/// --laps, --vision, --camera, --vehicle, --speed and the flags that every subcommand has.
void add_race_options(Command& command, RaceOptions& options);

/// The races that these options mean; says what the configuration has to say.
/// @throws std::runtime_error one line, as RaceMaker does.
[[nodiscard]] simulated_race::RaceMaker race_maker(const RaceOptions& options);

/// "gatefly fly TRACK --seed N ..." that flies one of these races alone.
[[nodiscard]] std::string fly_command(const RaceOptions& options, const std::string& seed);

/// An argument as a shell wants it.
[[nodiscard]] std::string shell_quoted(const std::string& text);

/// " --laps 2 --set ...": these options but the track, as a shell takes them.
[[nodiscard]] std::string race_flags(const RaceOptions& options);

}  // namespace gatefly::cli
