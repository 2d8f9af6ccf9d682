// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/stray_passes.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::sim {
namespace {

enum class Crossing { kNone, kForwards, kBackwards };

Crossing crossing(const world::WorldGate& gate, const Eigen::Vector3d& before_E,
                  const Eigen::Vector3d& now_E) {
  // Seldom is one near.
  if (gate.missing || (now_E - gate.p_EG).squaredNorm() > gate.side * gate.side)
    return Crossing::kNone;
  const Eigen::Matrix3d R_GE = rotation_z(-gate.yaw_EG);
  const Eigen::Vector3d before = R_GE * (before_E - gate.p_EG), now = R_GE * (now_E - gate.p_EG);
  if ((before.x() < 0.0) == (now.x() < 0.0)) return Crossing::kNone;
  const Eigen::Vector3d at = before + before.x() / (before.x() - now.x()) * (now - before);
  if (std::max(std::abs(at.y()), std::abs(at.z())) >= 0.5 * gate.side - gate.bar)
    return Crossing::kNone;
  return now.x() >= 0.0 ? Crossing::kForwards : Crossing::kBackwards;
}

}  // namespace

void StrayPasses::update(const Eigen::Vector3d& p_EB, int next) {
  if (last_E_) {
    for (const world::WorldGate& gate : world_.false_gates)
      false_ += crossing(gate, *last_E_, p_EB) != Crossing::kNone;
    if (next != counted_for_) counted_for_ = -1;
    for (int i = 0; i < static_cast<int>(world_.gates.size()) && counted_for_ < 0; ++i) {
      if (i == next || crossing(world_.gates[static_cast<std::size_t>(i)], *last_E_, p_EB) !=
                           Crossing::kForwards)
        continue;
      ++others_;
      counted_for_ = next;
    }
  }
  last_E_ = p_EB;
}

}  // namespace gatefly::sim
