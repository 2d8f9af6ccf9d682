// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "gatefly/control/attitude_command.hpp"
#include "gatefly/control/control_params.hpp"
#include "gatefly/estimation/low_pass.hpp"
#include "gatefly/geometry/frames.hpp"

namespace gatefly {

/// Attitude control by incremental nonlinear dynamic inversion. Smeur et al. 2016; adaptive on
/// request, as flown not.
///
/// Angular acceleration is measured (filtered gyro, differenced), compared with the wanted one, and
/// only the difference is put on the rotors: what the model does not know is already in the
/// measurement.
class Indi {
 public:
  Indi(const IndiParams& params, const VehicleParams& vehicle);
  void reset();

  /// How well each axis obeys, relative to what the vehicle's numbers say: 1 unless adaptive.
  [[nodiscard]] const Eigen::Vector3d& effectiveness() const { return effectiveness_; }

  /// Rotor speeds that bring the attitude to `command` [rad/s].
  /// @param rate_B  gyro without bias [rad/s]
  std::array<double, 4> step(const AttitudeCommand& command, const RotationEB& R_EB,
                             const Eigen::Vector3d& rate_B, double dt);

 private:
  /// Angular acceleration and specific thrust that four rotor thrusts [N] give.
  [[nodiscard]] Eigen::Vector4d effect_of(const Eigen::Vector4d& thrusts) const {
    return effect_ * thrusts;
  }

  void adapt(const Eigen::Vector3d& accel, const Eigen::Vector3d& produced);

  IndiParams params_;
  VehicleParams vehicle_;
  Eigen::Vector3d effectiveness_ = Eigen::Vector3d::Ones();
  Eigen::Matrix4d effect_, allocation_;
  LowPass rate_filter_, actuator_filter_;
  Eigen::Vector3d last_accel_ = Eigen::Vector3d::Zero(), last_produced_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d last_rate_ = Eigen::Vector3d::Zero();
  Eigen::Vector4d rotor_thrusts_ = Eigen::Vector4d::Zero();  ///< Modelled, with lag [N].
  bool started_ = false;
};

}  // namespace gatefly
