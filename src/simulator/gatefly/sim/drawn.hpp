// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "gatefly/world/randomize.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// One seed's truth around the nominal one. The pilot keeps the nominal.
[[nodiscard]] world::SimConfig drawn(const world::SimConfig& nominal, const world::Randomize& sigma,
                                     std::uint64_t seed);

}  // namespace gatefly::sim
