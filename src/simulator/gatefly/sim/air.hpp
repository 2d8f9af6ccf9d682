// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/gusts.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// The air of a jet at a place on the floor plan [m/s].
///
/// Aside of the axis by y it moves with speed · cos²(π y / 2 width), from |y| = width on not at all:
/// half as fast at half the width, and as much air in all as `speed` over `width`.
[[nodiscard]] Eigen::Vector2d jet_at(const world::Jet& jet, const Eigen::Vector2d& p_E);

/// The air of a shear there [m/s].
[[nodiscard]] Eigen::Vector2d shear_at(const world::Shear& shear, const Eigen::Vector2d& p_E);

/// The nominal wash of rotors at hover that comes back from the walls of a room there, on average,
/// away from each wall [m/s]: 0.5 (1 − d)² at `d` metres from it, nothing from 1 m on.
///
/// [estimate: the wake is a jet of 11 m/s (momentum theory) that spreads along the floor as 1 / way
/// and climbs the wall with 1 m/s or so where it is 1 m away; some tenths of that turn back. Rotors
/// less than their diameter from a wall are rather sucked towards it: not modelled.]
[[nodiscard]] Eigen::Vector2d wash_at(const Eigen::AlignedBox2d& room, const Eigen::Vector2d& p_E);

/// The air around the body: a mean, what stands still in the room, gusts, the own wash.
class Air {
 public:
  explicit Air(const world::SimConfig& config);

  /// After another `dt` [s], for a body that is where `state` says.
  /// @param rotors  their mean speed, of that at hover: the wash goes with it.
  void advance(const BodyState& state, double rotors, double time, double dt);
  /// Earth frame [m/s].
  [[nodiscard]] const Eigen::Vector3d& velocity_E() const { return velocity_E_; }

 private:
  /// Recirculation comes and goes: as strong as its mean, for about half a second.
  [[nodiscard]] Eigen::Vector2d wash(const Eigen::Vector2d& p_E, double dt);

  world::Wind wind_;
  world::Faults faults_;
  Eigen::AlignedBox2d room_;  ///< Floor plan.
  Gusts gusts_;
  Stream flicker_;
  double flickering_ = 0.0;  ///< Standard normal.
  Eigen::Vector3d velocity_E_ = Eigen::Vector3d::Zero();
};

}  // namespace gatefly::sim
