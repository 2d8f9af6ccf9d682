// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/race/pilot_config.hpp"

namespace gatefly::tasks {

/// Gates, best first; where there are none, or all are asked for, one that the border cuts.
/// @param all  every gate, instead of the best.
[[nodiscard]] std::vector<GateDetection> gates_in_picture(const Image& image,
                                                          GateDetector& detector,
                                                          const PilotConfig& config, bool all);

}  // namespace gatefly::tasks
