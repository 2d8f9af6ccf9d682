// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/race/path.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly {

/// The legs as the paper's team wrote them down: each gate's `exit`, then straight along the axis of
/// the next gate.
///
/// Source: Li18 §4 and its flight code's table of legs. Obstacles are not looked at. An arc drawn on
/// paper need not end on the next gate's axis, the flown one is wider: the path jumps there.
/// Start-up only: allocates and throws.
/// @throws std::invalid_argument naming the gate that has no exit, or whose arc does not end before
///     the next gate, facing it.
[[nodiscard]] RacePlan plan_from_exits(const Track& track);

}  // namespace gatefly
