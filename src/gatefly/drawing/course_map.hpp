// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/race/path.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly::io {

/// A course from above, north up: room, obstacles, start, numbered gates with their direction, the
/// planned way.
///
/// @param plan  nullptr: there is none.
/// @param title  above it, on one line.
[[nodiscard]] Canvas drawn_course(const Track& track, const RacePlan* plan,
                                  const std::string& title);

}  // namespace gatefly::io
