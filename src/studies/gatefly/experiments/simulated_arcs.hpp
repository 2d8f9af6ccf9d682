// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/half_circles.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::experiments {

/// One way to fly the paper's control scheme in the simulator.
struct ArcFlights {
  std::string level;                       ///< Level of the seeds' draws: "none", "race".
  std::vector<std::string> settings = {};  ///< As `gatefly fly --set`.
  std::function<void(world::SimConfig&)> change =
      {};  ///< Applied to the drawn truth; may be empty.
  int flights = 1, laps = 1;
  std::uint64_t first_seed = 1;
};

/// Blind half circles of simulated flights, by the true motion alone.
struct SimulatedArcs {
  std::vector<BlindArc> arcs;      ///< By the nose, as in a recording.
  std::vector<BlindArc> by_pilot;  ///< The same ones, from the pilot's switch to its switch back.
  std::vector<LeftOut> left_out;
  std::map<std::string, int> ends;  ///< How many flights ended how.
};

/// Flies them with ideal vision, several at a time. @throws Stopped; std::runtime_error as the
/// files' readers.
[[nodiscard]] SimulatedArcs simulated_arcs(const ArcFlights& flights, const Options& options);

}  // namespace gatefly::experiments
