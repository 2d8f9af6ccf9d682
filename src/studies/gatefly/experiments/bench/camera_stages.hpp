// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "gatefly/experiments/bench/stage.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::bench {

/// A frame of the simulated camera: all effects, and fast beside it.
///
/// Seen from 1 to 6 m before each gate of the seed's world, in motion. Bakes the room's light, or
/// reads it from `config.cache_dir`.
/// @param while_baking  called some twenty times a second; may throw to stop.
[[nodiscard]] std::vector<Stage> camera_stages(const world::SimConfig& config,
                                               const std::function<void()>& while_baking);

}  // namespace gatefly::bench
