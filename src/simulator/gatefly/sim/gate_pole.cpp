// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/gate_pole.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::sim {
namespace {

/// Whether the middle of `lower`'s opening is under the gate that ends at this height.
bool is_beneath(const world::WorldGate& lower, const world::WorldGate& gate, double gate_bottom) {
  if (lower.missing || -lower.p_EG.z() > gate_bottom) return false;
  const Eigen::Vector3d off_G = rotation_z(-lower.yaw_EG) * (gate.p_EG - lower.p_EG);
  return std::max(std::abs(off_G.x()), std::abs(off_G.y())) < 0.5 * lower.side;
}

}  // namespace

GatePole pole_of(const world::WorldGate& gate, const world::World& world) {
  GatePole pole{.top = -gate.p_EG.z() - 0.5 * gate.side};
  const double lower_edge = pole.top;
  for (const auto* gates : {&world.gates, &world.false_gates})
    for (const world::WorldGate& lower : *gates)
      if (is_beneath(lower, gate, lower_edge))
        pole.bottom = std::max(pole.bottom, -lower.p_EG.z() + 0.5 * lower.side);
  pole.top = std::max(pole.top, pole.bottom);
  return pole;
}

}  // namespace gatefly::sim
