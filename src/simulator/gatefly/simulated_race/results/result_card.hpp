// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::simulated_race {

/// How a race went - gates, laps, times, speeds, errors - over a dimmed frame.
/// @param verdict  in words: "crashed into a pole at ...".
void draw_result_card(drawing::Canvas& canvas, const RaceResult& result,
                      const std::string& verdict);

}  // namespace gatefly::simulated_race
