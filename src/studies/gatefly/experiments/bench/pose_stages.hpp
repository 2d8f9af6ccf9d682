// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gatefly/experiments/bench/stage.hpp"

namespace gatefly::bench {

/// A pose from four corners: ours beside OpenCV's ways, on the same 500 gates.
[[nodiscard]] std::vector<Stage> pose_stages();

}  // namespace gatefly::bench
