// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::simulated_race {

/// Why a race was lost, in one sentence; "" when it was not.
///
/// "Lost at gate 3 of 15: touched its right bar, 21 cm off centre (20 right, 6 low): 17 cm the
/// estimate (no fix for 1.8 s, wind 0.3 m/s from the left), 3 cm guidance, 1 cm the map."
[[nodiscard]] std::string loss_line(const RaceResult& result);

/// summary.json's "why_lost": that line and its numbers; null when the race was not lost.
/// Lateral to the right, vertical down, along ahead, as "gate_offsets_m".
[[nodiscard]] nlohmann::ordered_json loss_json(const RaceResult& result);

}  // namespace gatefly::simulated_race
