// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/world/world.hpp"

namespace gatefly::sim {

/// Counts flights through a gate that is not the next one, which the referee does not count.
///
/// A pass is the centre of mass crossing the gate's plane inside its opening. A false gate counts each
/// time and in either direction. A gate of the map counts forwards only, as flying back through one is
/// allowed, and once for each gate that is the next one: after a gate that was missed all others come out
/// of their turn. Sees nothing but the truth.
class StrayPasses {
 public:
  explicit StrayPasses(const world::World& world) : world_{world} {}

  /// To be told of every step of the physics.
  /// @param p_EB  centre of mass, earth frame [m]. @param next  index of the gate to fly next.
  void update(const Eigen::Vector3d& p_EB, int next);

  [[nodiscard]] int through_false_gates() const { return false_; }
  [[nodiscard]] int through_other_gates() const { return others_; }  ///< Of the map, out of turn.

 private:
  world::World world_;
  std::optional<Eigen::Vector3d> last_E_;
  int false_ = 0, others_ = 0;
  int counted_for_ = -1;  ///< The next gate when one of the map was counted last.
};

}  // namespace gatefly::sim
