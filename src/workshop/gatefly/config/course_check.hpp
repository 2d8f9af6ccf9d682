// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/race/track.hpp"

namespace gatefly::config {

/// Problems of a course as it stands, each in one sentence; empty when there are none.
///
/// Asks of the map alone: gates whole inside the room and apart from each other, ways into and out
/// of their openings free, obstacles inside the room and off the gates, the start free. Whether
/// there is a way round is the planner's question.
[[nodiscard]] std::vector<std::string> course_problems(const Track& track);

}  // namespace gatefly::config
