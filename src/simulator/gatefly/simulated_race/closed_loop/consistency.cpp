// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/consistency.hpp"

#include <Eigen/Cholesky>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::simulated_race {

Belief belief_of(const Pilot& pilot, bool picture) {
  const Phase& phase = pilot.phase();
  const bool on_course = std::holds_alternative<Straight>(phase) ||
                         std::holds_alternative<Turn>(phase) ||
                         std::holds_alternative<Search>(phase);
  if (!on_course || pilot.finished()) return {};
  const Estimate estimate = pilot.estimate();
  return {true, pilot.target_gate(), estimate.p_GB, estimate.covariance_GB,
          picture ? &pilot.sighting() : nullptr};
}

void ConsistencyWatch::update(const Belief& belief, const Eigen::Vector3d& true_p_EB, double time) {
  if (!belief.on_course) return;
  const Sighting* seen = belief.sighting;
  if (seen != nullptr && seen->source != Sighting::Source::kNone)
    result_.nis.add(seen->nis, seen->nis_dof);

  const auto target = static_cast<std::size_t>(belief.target);
  const world::WorldGate& gate = gates_[target];
  const Eigen::Vector3d error = rotation_z(-gate.yaw_EG) * (true_p_EB - gate.p_EG) - belief.p_GB;
  constexpr double kPeriod = 0.05, kFar = 1.0, kLong = 1.0;  // [s], [m], [s]
  if (time >= next_) {
    next_ = time + kPeriod;
    result_.nees.add(error.dot(belief.covariance_GB.ldlt().solve(error)), 3);
  }
  const Eigen::Vector3d believed_E = rotation_z(map_.gates[target].yaw_EG) * belief.p_GB;
  if (!((true_p_EB - gate.p_EG - believed_E).norm() > kFar)) {
    far_since_ = -1.0;
    return;
  }
  if (far_since_ < 0.0) far_since_ = time, seen_while_far_ = counted_ = false;
  seen_while_far_ = seen_while_far_ || (seen != nullptr && seen->offered);
  if (!counted_ && seen_while_far_ && time - far_since_ > kLong)
    ++result_.divergences, counted_ = true;
}

}  // namespace gatefly::simulated_race
