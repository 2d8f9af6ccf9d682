// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "gatefly/sim/air.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// Forces on the body but gravity and contacts: rotors with a lag, a battery that sags, the floor
/// below them, drag and moving air.
///
/// One model for MuJoCo's body and its twin. Values and sources: docs/simulation.md.
class Forces {
 public:
  explicit Forces(const world::SimConfig& config);

  /// Rotors, battery and air after another `dt` [s] with commanded rotor speeds [rad/s], for a
  /// body that is where `state` says; once a step. Non-finite commands stop the rotor.
  void advance(const std::array<double, 4>& command, const BodyState& state, double time,
               double dt);

  [[nodiscard]] const std::array<double, 4>& rotor_speed() const { return rotor_speed_; }
  [[nodiscard]] const Eigen::Vector3d& torque_B() const { return torque_B_; }  ///< [N m]
  /// The air around the body, earth frame [m/s].
  [[nodiscard]] const Eigen::Vector3d& wind_E() const { return air_.velocity_E(); }
  /// Thrust and drag on a body that flies so [N].
  [[nodiscard]] Eigen::Vector3d force_B(const Eigen::Matrix3d& R_EB,
                                        const Eigen::Vector3d& v_E) const;
  [[nodiscard]] double voltage() const { return voltage_; }  ///< The battery's [V].

 private:
  /// Voltage under the present load; takes its charge.
  void drain(double dt);

  world::VehicleTruth vehicle_;
  world::Faults faults_;
  Air air_;
  double hover_speed_;
  double full_voltage_ = 0.0, sagged_voltage_ = 0.0;  ///< Hovering: at first, after sag_time [V].
  double charge_ = 1.0, voltage_ = 0.0;               ///< Part of the capacity, [V].
  std::array<double, 4> rotor_speed_{};
  double thrust_ = 0.0, mean_speed_ = 0.0;
  Eigen::Vector3d torque_B_ = Eigen::Vector3d::Zero();
};

/// Thrust near the floor / far from it, rotors of `radius` at `height` above it, `side` apart along
/// the body's edges [m]. Sanchez-Cuevas, Heredia, Ollero 2017, eq. 9, K_b = 2; its floor is reached
/// half a radius up.
[[nodiscard]] double ground_effect(double height, double radius, double side);

}  // namespace gatefly::sim
