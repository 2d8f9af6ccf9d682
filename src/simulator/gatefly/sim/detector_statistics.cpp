// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/detector_statistics.hpp"

#include <stdexcept>

#include "gatefly/sim/detector_tables.hpp"
#include "gatefly/sim/wide_gates_table.hpp"

namespace gatefly::sim {

GateBuild build_of(std::span<const world::WorldGate> gates) {
  constexpr double kBetween = 0.2;  // of the side: from here on the detector takes bars for boards
  double share = 0.0;
  for (const world::WorldGate& gate : gates)
    share += gate.bar / gate.side / static_cast<double>(gates.size());
  return share > kBetween ? GateBuild::kWide : GateBuild::kThin;
}

const DetectorStatistics& statistics_of(const std::string& detector, GateBuild build) {
  if (detector == "ours") return build == GateBuild::kWide ? kOurDetectorOfWideGates : kOurDetector;
  if (detector == "paper") return kPapersDetector;
  throw std::invalid_argument("detector \"" + detector + "\", must be ours or paper");
}

}  // namespace gatefly::sim
