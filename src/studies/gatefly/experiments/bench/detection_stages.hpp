// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "gatefly/experiments/bench/picture.hpp"
#include "gatefly/experiments/bench/stage.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly::bench {

/// All that looks for gates, each on every picture; the baseline first when OpenCV is there.
[[nodiscard]] std::vector<Stage> detection_stages(
    std::shared_ptr<const std::vector<Picture>> pictures, const PilotConfig& config);

}  // namespace gatefly::bench
