// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/sim/collisions.hpp"
#include "gatefly/sim/forces.hpp"
#include "gatefly/sim/solids.hpp"

namespace gatefly::sim {

/// The body without MuJoCo: the same forces and the same shapes, integrated by Runge-Kutta. Much
/// faster.
///
/// Flies like `Body` (tests/sim/twin_body_test.cpp) and names what it touches. The floor carries
/// it; from anything else it does not bounce, for a touch ends the race.
class TwinBody {
 public:
  explicit TwinBody(const world::SimConfig& config);

  /// One step of `dt` [s] with commanded rotor speeds [rad/s].
  void step(const std::array<double, 4>& command, double dt);

  [[nodiscard]] const BodyState& state() const { return state_; }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double battery_v() const { return forces_.voltage(); }  ///< Under load [V].

  /// Object that the body touches now ("gate 3 left bar", "floor", "obstacle 7"), if any.
  [[nodiscard]] std::optional<std::string> contact() const;

  /// Obstacles between two points of its world.
  [[nodiscard]] const Sight& sight() const { return sight_; }

 private:
  void stand_on_floor();

  world::VehicleTruth vehicle_;
  Forces forces_;
  Collisions collisions_;
  SolidSight sight_;
  std::vector<Eigen::Vector3d> corners_B_;
  BodyState state_;
  double time_ = 0.0;
  bool on_floor_ = true;
};

}  // namespace gatefly::sim
