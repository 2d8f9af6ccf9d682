// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sim/body_state.hpp"
#include "gatefly/world/sim_config.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::sim {

/// One gate passed, as the truth has it.
struct GatePass {
  int gate = 0;                  ///< Index into the world's gates.
  double time = 0.0;             ///< When the centre of mass crossed the plane [s].
  Eigen::Vector2d offset{0, 0};  ///< The centre of mass there: right, down [m].
};

/// Counts gates: one is passed when every point of body and propeller discs has crossed its plane
/// inside the opening, forwards, in order. Sees nothing but the truth.
class Referee {
 public:
  Referee(const world::World& world, const world::VehicleTruth& vehicle, int laps);

  /// @return the pass that is complete with this state, if any.
  std::optional<GatePass> update(const BodyState& state, double time);

  [[nodiscard]] int passed() const { return passed_; }
  [[nodiscard]] int total() const { return total_; }
  /// Index into the world's gates, of the one to fly next.
  [[nodiscard]] int next() const { return passed_ % static_cast<int>(world_.gates.size()); }
  [[nodiscard]] bool finished() const { return passed_ >= total_; }

 private:
  struct Point {
    Eigen::Vector3d p_B;
    bool inside_crossing = false;  ///< Has crossed forwards inside the opening, and not come back.
  };
  [[nodiscard]] Eigen::Vector3d in_gate(const Eigen::Vector3d& p_E) const;
  void forget();

  world::World world_;
  int total_, passed_ = 0;
  std::vector<Point> points_;
  /// Places of each point, then of the centre; empty before the first state.
  std::vector<Eigen::Vector3d> last_G_;
  std::optional<GatePass> centre_;  ///< The centre's forward crossing.
  double last_time_ = 0.0;
};

}  // namespace gatefly::sim
