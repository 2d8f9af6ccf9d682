// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/config/derived.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/sim/drawn.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::test {

/// A race as `gatefly fly` sets it up.
/// @param level  of randomization; "": the track's own.
inline simulated_race::RaceConfig race_on(const std::string& track, std::uint64_t seed, int laps,
                                          const std::vector<std::string>& configs = {},
                                          const std::string& level = "",
                                          const world::Faults& faults = {}) {
  const config::Config config = config::load_config(config::config_files(configs));
  config::TrackFile file = config::read_track(config::find_track(track));
  simulated_race::RaceConfig race;
  race.pilot = config.pilot;
  race.pilot.track = file.track;
  race.pilot.track.laps = laps;
  world::SimConfig nominal = config::simulator_config(config, file);
  nominal.cache_dir = std::filesystem::temp_directory_path() / "gatefly-test-cache";
  nominal.faults = faults;
  race.sim =
      sim::drawn(nominal, level.empty() ? file.randomize : world::randomize_level(level), seed);
  return race;
}

}  // namespace gatefly::test
