// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "gatefly/link/rate_curve.hpp"
#include "gatefly/link/throttle_curve.hpp"
#include "gatefly/sensing/imu.hpp"
#include "gatefly/sim/autopilot/smoothing.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// A set point as a companion sends it: sticks, and whether the motors may turn.
struct SetPoint {
  msp::Sticks sticks = msp::kNeutral;
  bool armed = false;
};

/// How the sticks are read: the rates, the throttle and the largest angle that an autopilot is set to.
struct StickCurves {
  explicit StickCurves(const world::AutopilotTruth& truth);
  msp::RateProfile rates;
  msp::ThrottleCurve throttle;
  double most_angle;  ///< Roll or pitch with the stick at its end [rad].

  /// Angle of a stick, straight from its middle to its ends [rad].
  [[nodiscard]] double angle(int stick) const;
  [[nodiscard]] int angle_stick(double angle) const;
};

/// Throttle, 0 … 1000, that turns a rotor at `speed`, of `highest` [rad/s].
[[nodiscard]] int throttle_of(double speed, double highest);

/// A flight controller: smooths the sticks, holds rates by its gyro, or angles by its own idea of what
/// is level, and says how fast the rotors turn.
///
/// Source: Betaflight's documented order of things: set points through three first-order low-passes, a
///   PID on the filtered gyro whose derivative acts on the gyro alone, a mixer that keeps the
///   differences and moves the throttle. Its gains are those of an owner who has tuned it: from the
///   vehicle's rotors and inertia, for a response of ω = 1.4 / τ and ζ = 0.7, τ being the rotors' lag.
/// Gravity corrects roll and pitch slowly (Mahony et al. 2008), whatever the drone accelerates: held
/// angles drift, held rates do not.
class Autopilot {
 public:
  Autopilot(const world::AutopilotTruth& truth, const world::VehicleTruth& vehicle);

  /// Rotor speeds [rad/s], after one more sample of the IMU; `dt` since the one before [s]. What is no
  /// number is left out.
  std::array<double, 4> step(const SetPoint& wanted, const Imu& imu, double dt);

  /// Roll and pitch as it believes them [rad].
  [[nodiscard]] Eigen::Vector2d angles() const;

 private:
  void level(const Imu& imu, double dt);
  [[nodiscard]] Eigen::Vector3d wanted_rates(const Eigen::Vector4d& smoothed) const;
  [[nodiscard]] std::array<double, 4> mixed(const Eigen::Vector3d& turn, double throttle) const;

  world::AutopilotTruth truth_;
  world::VehicleTruth vehicle_;
  StickCurves curves_;
  Eigen::Vector3d kp_, kd_, ki_;  ///< [1/s], [], [1/s²]
  Eigen::Vector3d
      turn_per_throttle_;  ///< Angular acceleration of a full throttle of difference [rad/s²].
  Smoothing<4> sticks_;    ///< Roll, pitch, yaw as rates or angles, throttle.
  LowPass1<3> gyro_, derivative_;
  Eigen::Vector3d last_gyro_ = Eigen::Vector3d::Zero(), integral_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d up_B_{0, 0, -1}, bias_ = Eigen::Vector3d::Zero();
  int rested_ = 0;  ///< Samples while the motors were off, for the bias.
  bool started_ = false;
};

}  // namespace gatefly::sim
