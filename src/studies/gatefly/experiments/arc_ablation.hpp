// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gatefly/experiments/blind_arc.hpp"
#include "gatefly/experiments/experiment.hpp"

namespace gatefly::experiments {

/// How many flights of which seeds.
struct ArcFlightCount {
  int flights = 1, laps = 1;
  std::uint64_t first_seed = 1;
};

/// Reports causes that move the end of a simulated arc: the pilot's errors are put right, one thing
/// after the other; then, with everything right, one thing is made wrong. Level none.
/// @param as_flown  the same flights, untouched.
void report_ablation(const std::vector<BlindArc>& as_flown, const ArcFlightCount& count,
                     const Options& options, Result& result);

}  // namespace gatefly::experiments
