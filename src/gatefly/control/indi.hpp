// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "gatefly/control/attitude_command.hpp"
#include "gatefly/estimation/low_pass.hpp"
#include "gatefly/geometry/frames.hpp"

namespace gatefly {

/// The drone as its team knows it. Rotor order: left front, right front, right back, left back.
struct VehicleParams {
  double mass = 0.42;  ///< [kg] Bebop 1 with guards.
  /// Diagonal, body axes [kg m²]. [ours: box model]
  Eigen::Vector3d inertia{0.0021, 0.0020, 0.0035};
  /// Rotor distance from the centre along x, y [m].
  double arm_x = 0.112, arm_y = 0.095;
  /// Thrust / speed² [N/(rad/s)²]: hovers at 7,380 rpm.
  double thrust_coefficient = 1.72e-6;
  double torque_coefficient = 0.016;             ///< Yaw torque / thrust [m].
  double min_speed = 150.0, max_speed = 1250.0;  ///< Of a rotor [rad/s].
  double rotor_time_constant = 0.0185;           ///< [s] [Li18 code: 0.1 per 512 Hz sample]
};

struct IndiParams {
  /// On the error angle [1/s²]: ω_n² . [Li18 code: 200 -> 14.1 rad/s]
  double attitude_gain = 180.0;
  double rate_gain = 24.0;  ///< 2 ζ ω_n [1/s]. [Li18 code: 28]
  double yaw_attitude_gain = 20.0;
  double yaw_rate_gain = 9.0;
  double max_yaw_rate = 2.8;     ///< [rad/s] [Li18 code: 2.1; ours: tight arcs at 1.6 m/s need 2]
  double filter_hz = 11.0;       ///< Of rates and actuators. [Li18 code: 50 rad/s = 8 Hz]
  double filter_damping = 0.70;  ///< [Li18 code: 0.55]
  double sample_hz = 512.0;
  /// What rotors do is learnt in flight. [Smeur et al. 2016; off as flown, Li18 code]
  bool adaptive = false;
  double adaptation = 0.01;  ///< Step of the normalised LMS. [ours: a few seconds of flight]
  /// Changes from sample to sample below this say nothing [rad/s²]. [ours: gyro noise]
  double adaptation_floor = 0.3;
  /// Nominal effectiveness / this .. times this is believed. [ours]
  double max_effectiveness_ratio = 3.0;
};

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
