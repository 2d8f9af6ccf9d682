// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/sim/detector_tables.hpp"

namespace gatefly::sim {

inline const DetectorStatistics kOurDetectorOfWideGates = kOurDetector;

}  // namespace gatefly::sim
