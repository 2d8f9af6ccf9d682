// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/detector_statistics.hpp"

#include <stdexcept>

#include "gatefly/sim/detector_tables.hpp"

namespace gatefly::sim {

const DetectorStatistics& statistics_of(const std::string& detector) {
  if (detector == "ours") return kOurDetector;
  if (detector == "paper") return kPapersDetector;
  throw std::invalid_argument("detector \"" + detector + "\", must be ours or paper");
}

}  // namespace gatefly::sim
