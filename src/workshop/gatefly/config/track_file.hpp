// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gatefly/config/descriptions.hpp"
#include "gatefly/race/track.hpp"
#include "gatefly/world/randomize.hpp"
#include "gatefly/world/sim_config.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::config {

/// A course as its file describes it: for the pilot, for the simulator, and what a seed changes.
struct TrackFile {
  Track track;         ///< The pilot's map.
  world::World world;  ///< The same as nominal truth; `sim::drawn` moves it.
  world::StartTruth start;
  world::Randomize randomize;  ///< Level of the file with its overrides.
  world::Faults faults;
};

/// Reads tracks/*.toml. Format: see tracks/oval.toml.
///
/// @param gates  what a gate measures and looks like where the file does not say.
/// @throws std::runtime_error one line: file, line, key, value, what is allowed.
[[nodiscard]] TrackFile read_track(const std::filesystem::path& path,
                                   const GateDescription& gates = {});

/// Allowed values of a gate's `color`.
[[nodiscard]] std::vector<std::string> track_colors();

/// A track file by path or by its name in tracks/.
/// @throws std::runtime_error listing the tracks there are.
[[nodiscard]] std::filesystem::path find_track(const std::string& name);

}  // namespace gatefly::config
