// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/referee.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/sim/collisions.hpp"

namespace gatefly::sim {

Referee::Referee(const world::World& world, const world::VehicleTruth& vehicle, int laps)
    : world_{world}, total_{static_cast<int>(world.gates.size()) * laps} {
  for (const Eigen::Vector3d& point : outline_of(vehicle)) points_.push_back({point});
}

Eigen::Vector3d Referee::in_gate(const Eigen::Vector3d& p_E) const {
  const world::WorldGate& gate = world_.gates[static_cast<std::size_t>(next())];
  return rotation_z(-gate.yaw_EG) * (p_E - gate.p_EG);
}

void Referee::forget() {
  for (auto& point : points_) point.inside_crossing = false;
  last_G_.clear();
  centre_.reset();
}

std::optional<GatePass> Referee::update(const BodyState& state, double time) {
  if (finished() || world_.gates.empty()) return std::nullopt;
  const world::WorldGate& gate = world_.gates[static_cast<std::size_t>(next())];
  if (gate.missing) return std::nullopt;
  const double half_opening = 0.5 * gate.side - gate.bar;
  const Eigen::Matrix3d R_EB = R_EB_of(state.q_EB);

  const bool first = last_G_.empty();
  if (first) last_G_.resize(points_.size() + 1);
  std::size_t through = 0;
  for (std::size_t i = 0; i <= points_.size(); ++i) {
    const bool is_centre = i == points_.size();
    const Eigen::Vector3d now =
        in_gate(is_centre ? state.p_EB : Eigen::Vector3d{state.p_EB + R_EB * points_[i].p_B});
    const Eigen::Vector3d before = first ? now : last_G_[i];
    last_G_[i] = now;
    const bool forwards = before.x() < 0.0 && now.x() >= 0.0;
    const bool backwards = before.x() >= 0.0 && now.x() < 0.0;
    if (is_centre) {
      if (backwards) centre_.reset();
      if (forwards) {
        const double t = before.x() / (before.x() - now.x());
        const Eigen::Vector3d at = before + t * (now - before);
        centre_ = GatePass{next(), last_time_ + t * (time - last_time_), {at.y(), at.z()}};
      }
      continue;
    }
    if (backwards) points_[i].inside_crossing = false;
    if (forwards) {
      const double t = before.x() / (before.x() - now.x());
      const Eigen::Vector3d at = before + t * (now - before);
      points_[i].inside_crossing = std::max(std::abs(at.y()), std::abs(at.z())) < half_opening;
    }
    through += points_[i].inside_crossing;
  }
  last_time_ = time;
  if (through < points_.size() || !centre_) return std::nullopt;
  const GatePass pass = *centre_;
  ++passed_;
  forget();
  return pass;
}

}  // namespace gatefly::sim
