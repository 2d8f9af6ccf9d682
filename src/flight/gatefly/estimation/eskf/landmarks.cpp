// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/landmarks.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly::eskf {
namespace {

constexpr double kSamePlace = 0.3;  // [m] Two gates cannot stand so near each other.
constexpr std::size_t kAhead = 3;   // The target and the next two.
constexpr std::size_t kBehind = 2;  // So many of the last gates stay in view when turning round.

bool is_same(const Landmark& a, const Landmark& b) {
  return (a.p_EG - b.p_EG).norm() < kSamePlace && std::abs(gatefly::sin(a.yaw_EG - b.yaw_EG)) < 0.5;
}

}  // namespace

GateSigmas prior_of(const Landmark& gate, const Priors& priors) {
  if (gate.sigmas) return *gate.sigmas;
  return {priors.map, priors.map, priors.map_height, priors.map_yaw, priors.map_size};
}

Landmarks::Landmarks(std::span<const Landmark> map, const Priors& priors) : priors_{priors} {
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Landmark& gate = map[i];
    const bool known = std::any_of(known_.begin(), known_.end(),
                                   [&](const Known& k) { return is_same(k.map, gate); });
    if (!known) known_.push_back({gate, {}, GateSigmas::Zero(), -1, i});
  }
  slots_ = static_cast<int>(std::min(known_.size(), kMaxGates));
}

Landmarks::Face Landmarks::face_of(const Eigen::Vector3d& p_EG, double yaw_EG) const {
  Face face;
  for (std::size_t i = 1; i < known_.size(); ++i)
    if ((known_[i].map.p_EG - p_EG).norm() < (known_[face.landmark].map.p_EG - p_EG).norm())
      face.landmark = i;
  if (!known_.empty()) face.behind = gatefly::cos(yaw_EG - known_[face.landmark].map.yaw_EG) < 0.0;
  return face;
}

void Landmarks::reset(Nominal& x, Covariance& P) {
  for (std::size_t i = 0; i < known_.size(); ++i) {
    Known& gate = known_[i];
    gate.belief = {gate.map.p_EG, gate.map.yaw_EG, 0.0};
    gate.sigmas = prior_of(gate.map, priors_);
    gate.slot = -1;
  }
  for (int slot = 0; slot < slots_; ++slot) put_in(static_cast<std::size_t>(slot), slot, x, P);
}

void Landmarks::put_in(std::size_t landmark, int slot, Nominal& x, Covariance& P) {
  Known& gate = known_[landmark];
  gate.slot = slot;
  in_slot_[static_cast<std::size_t>(slot)] = landmark;
  x.gates[static_cast<std::size_t>(slot)] = gate.belief;
  P.middleRows<kPerGate>(gate_at(slot)).setZero();
  P.middleCols<kPerGate>(gate_at(slot)).setZero();
  P.diagonal().segment<kPerGate>(gate_at(slot)) = gate.sigmas.cwiseAbs2();
}

void Landmarks::take_out(int slot, const Nominal& x, const Covariance& P) {
  Known& gate = known_[in_slot(slot)];
  gate.belief = x.gates[static_cast<std::size_t>(slot)];
  gate.sigmas = P.diagonal().segment<kPerGate>(gate_at(slot)).cwiseMax(0.0).cwiseSqrt();
  gate.slot = -1;
}

void Landmarks::choose(std::size_t target) {
  for (std::size_t i = 0; i < known_.size(); ++i) {
    const std::size_t ahead = (i + known_.size() - target) % known_.size();
    known_[i].wanted = ahead < kAhead || ahead + kBehind >= known_.size();
  }
  const auto squared_distance = [&](const Known& gate) {
    return (gate.map.p_EG - known_[target].map.p_EG).squaredNorm();
  };
  for (std::size_t chosen = kAhead + kBehind; chosen < kMaxGates; ++chosen) {
    const auto nearest =
        std::min_element(known_.begin(), known_.end(), [&](const Known& a, const Known& b) {
          if (a.wanted || b.wanted) return b.wanted && !a.wanted;
          return squared_distance(a) < squared_distance(b);
        });
    nearest->wanted = true;
  }
}

bool Landmarks::bring_in(std::size_t target, Nominal& x, Covariance& P) {
  if (known_.size() <= kMaxGates) return false;
  choose(target);
  bool changed = false;
  int slot = 0;
  for (std::size_t landmark = 0; landmark < known_.size(); ++landmark) {
    if (known_[landmark].slot >= 0 || !known_[landmark].wanted) continue;
    // At most once a slot: as many gates are wanted as there are slots.
    while (known_[in_slot(slot)].wanted) ++slot;
    take_out(slot, x, P);
    put_in(landmark, slot, x, P);
    changed = true;
  }
  return changed;
}

}  // namespace gatefly::eskf
