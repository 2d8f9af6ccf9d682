// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <nlohmann/json.hpp>

#include "gatefly/race/path.hpp"
#include "gatefly/race/track.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::simulated_race {

/// A foxglove.SceneUpdate: gates where they stand and where the pilot's map has them, obstacles,
/// the way planned. North, west, up.
/// @param time  of the message [ns]
[[nodiscard]] nlohmann::ordered_json scene_of(const world::World& world, const Track& map,
                                              const RacePlan& plan, std::uint64_t time);

}  // namespace gatefly::simulated_race
