// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "gatefly/control/altitude.hpp"
#include "gatefly/control/attitude_command.hpp"
#include "gatefly/control/lateral_pd.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/race/course.hpp"
#include "gatefly/race/phase.hpp"

namespace gatefly {

struct SpeedParams {
  /// [rad/(m/s)] of speed error. [ours; paper: constant pitch]
  double pitch_gain = 0.14;
  double max_pitch = 14.0 * kDegree;   ///< Nose down.
  double min_pitch = -12.0 * kDegree;  ///< As nose up: braking.
  /// Roll starts this long before the curve [s]: INDI's lag. [ours]
  double roll_lead = 0.16;
  double brake_lead = 0.7;  ///< Slow down this long before the curve [s]. [ours]
  /// From the last turn to the gate at least [s]. [ours: PD, 2.1 rad/s]
  double settle = 1.3;
  double slowest = 1.0;  ///< ... unless that asks for less than this [m/s]. [ours]
  /// Towards a gate that has not been seen from here [m/s]. [ours]
  double unsure = 1.1;
  double unsure_before = 3.0;  ///< ... once it is nearer than this [m]. [ours]
  double unsure_after = 0.6;   ///< Not seen means: not for so long [s] ... [ours]
  double unsure_sigma = 0.2;   ///< ... and more uncertain to the side than this [m]. [ours]
  /// Of turn and correction together. [ours: INDI follows 40°]
  double max_roll = 38.0 * kDegree;
};

/// Position hold: before take-off is done, while searching, while landing.
struct HoldParams {
  double stiffness = 0.9;     ///< [1/s²] [ours: with the damping ω 0.95, ζ 1]
  double damping = 2.0;       ///< [1/s] [ours]
  double integral = 0.25;     ///< [1/s³] [ours: 1° of tilt would hold it 0.2 m beside]
  double max_integral = 0.5;  ///< [m/s²] [ours: 3° of tilt]
  double max_distance = 1.0;  ///< Farther away pulls no more [m]. [ours]
  double max_accel = 1.8;     ///< [m/s²] [ours: 10°]
  double max_braking = 3.5;   ///< [m/s²] [ours: 1.7 m/s stop in 0.9 m, roll's lag included]
  double brake_from = 1.5;    ///< Above this speed it brakes before it steers [m/s]. [ours]
  double climb_until = 0.25;  ///< Nearer to the floor the drone only goes up [m]. [ours]
};

struct SweepParams {
  double angle = 40.0 * kDegree;  ///< To both sides of the gate's axis. [ours: half the view]
  double period = 5.0;            ///< [s] [ours]
  double first_ahead = 1.5;       ///< Looks straight ahead for so long first [s]. [ours]
  double hold_after_fix = 0.5;    ///< And for so long after each fix [s]. [ours]
};

struct LandingParams {
  double brake = 1.0;  ///< First it stands still [s]. [ours]
  double sink = 0.5;   ///< Then it goes down [m/s]. [ours]
};

/// Everything guidance is told before take-off.
struct GuidanceParams {
  SpeedParams speed;
  LateralParams lateral;
  AltitudeParams altitude;
  HoldParams hold;
  SweepParams sweep;
  LandingParams landing;
  double cruise = 1.7;                 ///< Wanted on straights [m/s]. [paper: 1.5-1.8]
  double max_lateral = 3.2;            ///< v²/r an arc may ask for [m/s²]. [ours: 18°]
  Eigen::Vector2d drag{-0.52, -0.47};  ///< k_x, k_y [1/s]. [14 recorded flights]
  double gravity = 9.81;               ///< [m/s²]
};

/// The outer loop: which attitude and thrust each phase of the race asks for.
///
/// Source: Li18 §4, Eq. (22) on straights, Eq. (24)-(29) in turns. Differs: the pitch holds a speed,
/// and the PD trims the arc (docs/paper/deviations.md#eq-22, #eq-29).
class Guidance {
 public:
  explicit Guidance(const GuidanceParams& params) : params_{params} {}

  /// The command of this tick. A turn's own prediction goes on in `phase`.
  AttitudeCommand command(Phase& phase, const NavigationState& now, const Course& course);

  /// On the ground: integrals begin at zero.
  void reset() { altitude_.reset(); }

  /// Pictures count whenever it flies.
  [[nodiscard]] bool uses_pictures(const Phase& phase) const { return is_flying(phase); }

  /// Speed a turn begins with [m/s].
  [[nodiscard]] double entry_speed(const NavigationState& now) const { return now.v_B.x(); }

  /// Where the lateral PD will have brought the drone in the plane of the gate: metres to the right
  /// of its axis.
  [[nodiscard]] double lateral_at_gate(const NavigationState& now) const;

  /// The path curves where the drone will be when a roll that begins now is there.
  [[nodiscard]] bool turn_ahead(const NavigationState& now, const Course& course) const;

 private:
  AttitudeCommand take_off(const NavigationState& now, const Course& course);
  AttitudeCommand straight(const NavigationState& now, const Course& course);
  AttitudeCommand turn(Arc& arc, const NavigationState& now, const Course& course);
  AttitudeCommand search(const Search& phase, const NavigationState& now, const Course& course);
  AttitudeCommand land(const Land& phase, const NavigationState& now);
  AttitudeCommand hold(const Eigen::Vector2d& p_E, double yaw, double dt,
                       const NavigationState& now);

  [[nodiscard]] double wanted_speed(const NavigationState& now, const Course& course) const;
  [[nodiscard]] double pitch_for_speed(double speed, const NavigationState& now) const;
  [[nodiscard]] double cross_track_roll(const PathPoint& here, const NavigationState& now) const;
  [[nodiscard]] double thrust(double z, double vz, const NavigationState& now);

  GuidanceParams params_;
  Altitude altitude_;
  Eigen::Vector2d hold_integral_ = Eigen::Vector2d::Zero();  ///< [m/s²]
  std::size_t last_phase_ = 0;                               ///< Index of the last command's.
};

}  // namespace gatefly
