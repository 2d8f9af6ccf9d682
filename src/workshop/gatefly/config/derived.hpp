// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/config/config.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/race/pilot.hpp"
#include "gatefly/world/sim_config.hpp"

// Pilot and simulator each take what they need from the same descriptions, and nothing from each
// other.
namespace gatefly::config {

/// The pilot's own settings with what camera, vehicle and gate mean to it; without a track.
[[nodiscard]] PilotConfig pilot_config(const Config& config);

/// `config` for one course: where it has no colour but the generic orange, or says nothing of a gate's
/// side and bars, the track's gates do (its first one's side and bars).
/// Adds a note that names the gates that the pilot cannot tell by its colour.
[[nodiscard]] Config on_course(Config config, const TrackFile& track);

/// The simulator's own settings, what camera and vehicle mean to it, and the track's world; nominal:
/// nothing is drawn yet.
[[nodiscard]] world::SimConfig simulator_config(const Config& config, const TrackFile& track);

}  // namespace gatefly::config
