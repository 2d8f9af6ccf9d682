// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/world/world.hpp"

namespace gatefly::sim {

/// Counts flights through a gate that is not the next one, which the referee does not count.
///
/// A pass is the centre of mass crossing the gate's plane inside its opening. A false gate is not to
/// be flown through at all; a gate of the map out of its turn, forwards, as a confused pilot would:
/// the way back from one gate may lead through another. Sees nothing but the truth.
class StrayPasses {
 public:
  explicit StrayPasses(const world::World& world) : world_{world} {}

  /// @param p_EB  centre of mass, earth frame [m]. @param next  index of the gate to fly next.
  void update(const Eigen::Vector3d& p_EB, int next);

  [[nodiscard]] int through_false_gates() const { return false_; }
  [[nodiscard]] int through_other_gates() const { return others_; }  ///< Of the map, out of turn.

 private:
  world::World world_;
  std::optional<Eigen::Vector3d> last_E_;
  int false_ = 0, others_ = 0;
};

}  // namespace gatefly::sim
