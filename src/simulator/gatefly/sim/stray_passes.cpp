// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/stray_passes.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly::sim {
namespace {

enum class Crossing { kNone, kForwards, kBackwards };

Crossing crossing(const world::WorldGate& gate, const Eigen::Vector3d& before_E,
                  const Eigen::Vector3d& now_E) {
  if (gate.missing) return Crossing::kNone;
  const Eigen::Vector3d ahead_E{std::cos(gate.yaw_EG), std::sin(gate.yaw_EG), 0.0};
  const double before = ahead_E.dot(before_E - gate.p_EG), now = ahead_E.dot(now_E - gate.p_EG);
  if ((before < 0.0) == (now < 0.0)) return Crossing::kNone;
  const Eigen::Vector3d from_middle =
      before_E + before / (before - now) * (now_E - before_E) - gate.p_EG;
  const double aside = std::abs(ahead_E.x() * from_middle.y() - ahead_E.y() * from_middle.x());
  if (std::max(aside, std::abs(from_middle.z())) >= 0.5 * gate.side - gate.bar)
    return Crossing::kNone;
  return now >= 0.0 ? Crossing::kForwards : Crossing::kBackwards;
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
