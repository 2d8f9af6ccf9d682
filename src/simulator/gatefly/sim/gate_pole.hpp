// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/world/world.hpp"

namespace gatefly::sim {

/// The upright piece under a gate's lower bar, by heights above the floor [m].
struct GatePole {
  double bottom = 0.0, top = 0.0;
  [[nodiscard]] bool on_floor() const { return bottom == 0.0; }
  [[nodiscard]] double length() const { return top - bottom; }
};

/// It stands on the floor or, where another gate is beneath, on that gate's frame: no pole stands in
/// an opening. Without a length where the frames touch.
[[nodiscard]] GatePole pole_of(const world::WorldGate& gate, const world::World& world);

}  // namespace gatefly::sim
