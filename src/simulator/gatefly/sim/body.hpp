// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/forces.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// Rigid body, contacts and rangefinder by MuJoCo at about 1 kHz; rotors, drag, wind and battery
/// come from `Forces`.
///
/// MuJoCo's world is z-up: x north, y west. The conversion happens in this file and nowhere else.
class Body {
 public:
  /// @throws std::runtime_error with MuJoCo's message when the world cannot be built.
  explicit Body(const world::SimConfig& config);
  ~Body();

  /// One step of `dt` [s] with commanded rotor speeds [rad/s].
  void step(const std::array<double, 4>& command, double dt);

  [[nodiscard]] const BodyState& state() const { return state_; }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double battery_v() const { return forces_.voltage(); }  ///< Under load [V].

  /// Object that the body touches now ("gate 3", "floor", "obstacle 7", "wall"), if any.
  [[nodiscard]] std::optional<std::string> contact() const;

 private:
  struct Mujoco;
  void read_state();

  std::unique_ptr<Mujoco> mujoco_;
  Forces forces_;
  BodyState state_;
  double time_ = 0.0;
};

}  // namespace gatefly::sim
