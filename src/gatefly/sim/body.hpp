// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "gatefly/sim/random.hpp"
#include "gatefly/sim/sim_config.hpp"

namespace gatefly::sim {

/// The body's true motion, earth frame NED and body frame FRD.
struct BodyState {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_E = Eigen::Vector3d::Zero();
  Eigen::Vector4d q_EB{1, 0, 0, 0};  ///< w, x, y, z
  Eigen::Vector3d rate_B = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_B{0, 0, -9.81};  ///< What an ideal accelerometer reads [m/s²].
  std::array<double, 4> rotor_speed{};            ///< [rad/s]
};

/// Rigid body, contacts and rangefinder by MuJoCo at about 1 kHz; rotors, drag, wind and battery are ours.
///
/// MuJoCo's world is z-up: x north, y west. The conversion happens in this file and nowhere else.
class Body {
 public:
  /// @throws std::runtime_error with MuJoCo's message when the world cannot be built.
  explicit Body(const SimConfig& config);
  ~Body();

  /// One step of `dt` [s] with commanded rotor speeds [rad/s].
  void step(const std::array<double, 4>& command, double dt);

  [[nodiscard]] const BodyState& state() const { return state_; }
  [[nodiscard]] double time() const { return time_; }

  /// What the body touches now ("gate 3", "floor", "obstacle 7", "wall"), if anything.
  [[nodiscard]] std::optional<std::string> contact() const;

 private:
  struct Mujoco;
  void read_state();

  SimConfig config_;
  std::unique_ptr<Mujoco> mujoco_;
  BodyState state_;
  double time_ = 0.0;
  Stream wind_stream_;
  Eigen::Vector2d gust_ = Eigen::Vector2d::Zero();
};

}  // namespace gatefly::sim
