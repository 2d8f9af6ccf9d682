// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// What moves the body but gravity and contacts: rotors with a lag, drag, wind, a battery that
/// sags.
///
/// One model for MuJoCo's body and its twin. Values and sources: docs/simulation.md.
class Forces {
 public:
  explicit Forces(const SimConfig& config);

  /// Rotors and gusts after another `dt` [s] with commanded rotor speeds [rad/s]; once a step.
  /// Non-finite commands stop the rotor.
  void advance(const std::array<double, 4>& command, double time, double dt);

  [[nodiscard]] const std::array<double, 4>& rotor_speed() const { return rotor_speed_; }
  /// Mean and gusts, north and east, now [m/s].
  [[nodiscard]] Eigen::Vector2d wind_E() const { return wind_.mean + gust_; }
  [[nodiscard]] const Eigen::Vector3d& torque_B() const { return torque_B_; }  ///< [N m]
  /// Thrust and drag on a body that flies so [N].
  [[nodiscard]] Eigen::Vector3d force_B(const Eigen::Matrix3d& R_EB,
                                        const Eigen::Vector3d& v_E) const;

 private:
  VehicleTruth vehicle_;
  Wind wind_;
  Stream wind_stream_;
  double hover_speed_;
  std::array<double, 4> rotor_speed_{};
  double thrust_ = 0.0, mean_speed_ = 0.0;
  Eigen::Vector3d torque_B_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d gust_ = Eigen::Vector2d::Zero();
};

}  // namespace gatefly::sim
