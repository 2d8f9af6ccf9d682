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

/// One way to fly half circles in the simulator.
struct ArcFlights {
  std::string level;  ///< Level of the seeds' draws: "none", "race".
  /// "li18", the paper's scheme, or "default", ours; it is shown no gate from
  /// one gate to the end of the turn behind it.
  std::string config = "li18";
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
  /// Where the drone is, less where the plan has it, when the pilot believes itself at the end of the
  /// planned turn, and without the error that its place had at the gate before; as seen from that gate:
  /// ahead, right [m].
  std::vector<Eigen::Vector2d> off_plan;
  std::vector<double> blind;  ///< So long it had been since that gate [s].
};

/// Flies them with ideal vision, several at a time. @throws Stopped; std::runtime_error as the
/// files' readers.
[[nodiscard]] SimulatedArcs simulated_arcs(const ArcFlights& flights, const Options& options);

}  // namespace gatefly::experiments
