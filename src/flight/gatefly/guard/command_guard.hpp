// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include <Eigen/Core>

#include "gatefly/control/attitude_command.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/guard/hand_over.hpp"

namespace gatefly::guard {

/// Limits of what is sent. All ours, none flown yet.
struct CommandLimits {
  double tilt = 0.7;     ///< [rad], 40°.
  double thrust = 20.0;  ///< Specific, most of all [m/s²].
  std::chrono::nanoseconds height_trust =
      std::chrono::milliseconds{500};              ///< Without a height for longer: no climbing.
  double climb_damping = 2.0, fall_damping = 8.0;  ///< [1/s]
  /// A fall that the pilot's filter is sure of may be stopped, by no more than so much of the lift above what hovers, until the drone has
  /// risen by so much, were hover thrust exactly as thought and the filter wrong [m]. Betaflight's hover differs by 4 % from one way of
  /// flying to another: half a metre in a turn of a second and a half, two metres in three seconds.
  double stops_fall_by = 0.10, may_rise = 2.0;
  /// Speed of a descent if the rotors are as strong as they may be [m/s]: even then on the floor within 3 s from 1.5 m. Slower is not
  /// softer for those that are weaker, and longer in the air, where nobody sees what the drone drifts towards.
  double sink = 0.8;
  double hover_doubt = 0.10;  ///< Part by which they may give more than is thought.
  /// A climb that a gate told so lately is one to learn from; an accelerometer's is not.
  std::chrono::nanoseconds learns_from = std::chrono::milliseconds{60};
  double hover_time = 2.0;  ///< Time constant of the mean that is taken for hovering [s].
  /// Parts of the weight; beyond is not believed. An empty battery takes a fifth of the thrust, and a hover stick may be a tenth off.
  double least_hover = 0.8, most_hover = 1.3;
  /// A descent's lift fades after so long [s], at this rate, so that ground effect cannot hold the drone up.
  double fades_after = 1.5, fade = 0.05;  ///< [1/s²]
  /// Part of a descent's lift, when the pilot believes that it stands: what is left to fall is not much, and near the floor a gentle
  /// descent floats, and drifts, for seconds.
  double set_down = 0.85;
  double brake_time = 0.4;   ///< In which braking would stop, were there no limit [s].
  double brake_accel = 5.0;  ///< [m/s²]
};

/// The estimate that the guard acts by.
struct Belief {
  double yaw = 0.0;                               ///< [rad]
  Eigen::Vector3d v_E = Eigen::Vector3d::Zero();  ///< [m/s]
  double climb_sigma = 1e9;  ///< Standard deviation of v_E.z, as the filter knows it [m/s].
  std::chrono::nanoseconds height_age{0};  ///< Since a gate or a range finder told the height.
  bool stands = false;                     ///< The pilot has landed, it says.
};

/// The pilot's command after the guard's limits, as it goes to the drone.
///
/// A height that an accelerometer alone carries on drifts, and a pilot that holds it climbs: while nothing tells the height,
/// lift is not above the weight but for stopping a fall, by the speed that the thrust sent so far amounts to. That does not
/// drift with the accelerometer, and is off by what hover thrust is off: while gates tell the height, the pilot's own mean lift, less
/// what it has climbed by, shows what hovers. A fall that the filter believes in beyond its own sigma may be stopped, too, within
/// CommandLimits::may_rise.
///
/// An ending, braking and descent, knows no height. It goes by the strongest that the rotors may be: these would sink at
/// CommandLimits::sink, weaker ones faster, and none climb. It adds no lift against a fall that no gate has
/// measured.
class CommandGuard {
 public:
  explicit CommandGuard(const CommandLimits& limits = {}) : limits_{limits} {}

  /// The command of a period of `dt` [s]; kSilent and kNeutral: none, level without thrust. A command that is no number is
  /// one to descend.
  [[nodiscard]] AttitudeCommand step(Action action, const AttitudeCommand& pilot,
                                     const Belief& belief, double dt);

 private:
  [[nodiscard]] bool height_known(const Belief& belief) const;
  [[nodiscard]] AttitudeCommand limited(const AttitudeCommand& command, const Belief& belief) const;
  [[nodiscard]] AttitudeCommand descent(const Belief& belief) const;
  [[nodiscard]] double most_lift(const Belief& belief) const;
  [[nodiscard]] double ending_lift() const;
  void follow_ending(bool ending, const Belief& belief, double lift, double dt);
  void learn_hover(const Belief& belief, double dt);
  [[nodiscard]] AttitudeCommand braking(const Belief& belief) const;

  CommandLimits limits_;
  std::chrono::nanoseconds height_age_ = Situation::kNever;  ///< In the period before.
  double hover_ = kGravity;  ///< Lift that hovers, as the pilot's commands have shown [m/s²] ...
  double lift_ = 0.0, climb_ = 0.0;  ///< ... by the last lift and the climb when it was sent.
  bool learns_ = false;
  double up_ = 0.0;          ///< Climb by the thrust sent since the height was last told [m/s] ...
  double risen_ = 0.0;       ///< ... and the way up by it [m].
  double up_at_most_ = 0.0;  ///< The same of an ending, by the strongest rotors ...
  double ending_for_ = 0.0;  ///< ... since it began [s].
};

}  // namespace gatefly::guard
