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
#include "gatefly/race/race_params.hpp"

namespace gatefly {

struct SweepParams {
  double angle = 40.0 * kDegree;  ///< To both sides of the gate's axis. [ours: half the view]
  double period = 5.0;            ///< [s] [estimate]
  double first_ahead = 1.5;       ///< Looks straight ahead for so long first [s]. [estimate]
  double hold_after_fix = 0.5;    ///< And for so long after each fix [s]. [estimate]
};

struct LandingParams {
  double brake = 1.0;  ///< First it stands still [s]. [estimate]
  double sink = 0.5;   ///< Then it goes down [m/s]. [estimate]
  double hurry = 1.0;  ///< The same of one that cannot wait [m/s]. [a fall of 5 cm]
};

/// Everything guidance is told before take-off.
struct GuidanceParams {
  SpeedParams speed;
  LateralParams lateral;
  AltitudeParams altitude;
  HoldParams hold;
  SweepParams sweep;
  LookAsideParams look_aside;
  LandingParams landing;
  double cruise = 2.0;                 ///< Wanted on straights [m/s]. [ours; paper: 1.5-1.8]
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
  [[nodiscard]] double entry_speed(const NavigationState& now) const;

  /// Predicted crossing of the gate's plane under the lateral PD: metres to the right of its axis.
  /// While the way still turns before the gate, metres off the way, which ends on the axis.
  [[nodiscard]] double lateral_at_gate(const NavigationState& now, const Course& course) const;

  /// The path curves where the drone will be when a roll that begins now is there.
  [[nodiscard]] bool turn_ahead(const NavigationState& now, const Course& course) const;

 private:
  AttitudeCommand take_off(const NavigationState& now, const Course& course);
  AttitudeCommand straight(const NavigationState& now, const Course& course);
  AttitudeCommand turn(Arc& arc, const NavigationState& now, const Course& course);
  AttitudeCommand search(const Search& phase, const NavigationState& now, const Course& course);
  AttitudeCommand land(const Land& phase, const NavigationState& now);
  /// The next stop, when it is so near that the place is held.
  const Stop* near_stop(const Course& course) const;
  AttitudeCommand stand(const Stop& stop, const NavigationState& now, const Course& course);
  AttitudeCommand hold(const Eigen::Vector2d& p_E, double yaw, double dt,
                       const NavigationState& now);

  /// Turns the nose from the way towards the gate, and what was asked for along the way with it.
  AttitudeCommand look_aside(const AttitudeCommand& along, const NavigationState& now,
                             const Course& course);
  [[nodiscard]] double wanted_aside(double heading, const NavigationState& now,
                                    const Course& course) const;

  [[nodiscard]] double wanted_speed(const NavigationState& now, const Course& course) const;
  [[nodiscard]] double pitch_for_speed(double speed, const NavigationState& now) const;
  [[nodiscard]] double cross_track_roll(const PathPoint& here, const NavigationState& now) const;
  [[nodiscard]] double thrust(double z, double vz, const NavigationState& now);
  [[nodiscard]] double thrust_on_path(const NavigationState& now, const Course& course);

  GuidanceParams params_;
  Altitude altitude_;
  Eigen::Vector2d hold_integral_ = Eigen::Vector2d::Zero();  ///< [m/s²]
  std::size_t last_phase_ = 0;                               ///< Index of the last command's.
  double aside_ = 0.0;   ///< The nose is to point so far to the right of the way [rad], ...
  double turned_ = 0.0;  ///< ... and points so far [rad].
};

}  // namespace gatefly
