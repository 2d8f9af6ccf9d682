// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "gatefly/control/altitude.hpp"
#include "gatefly/control/attitude_command.hpp"
#include "gatefly/control/lateral_pd.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/race/course.hpp"
#include "gatefly/race/guidance.hpp"
#include "gatefly/race/phase.hpp"
#include "gatefly/race/race_params.hpp"

namespace gatefly {

/// The outer loop as flown: constant pitch, PD to the gate's axis, arcs open loop.
///
/// Source: Li18 §4, Eq. (22) on straights, Eq. (23)-(29) in turns, switch rules of its flight code.
/// In a turn nothing is looked at and nothing corrected; it ends by the heading. Differs: it lands as
/// ours does, the paper does not say how.
class PaperGuidance {
 public:
  /// @param ours  gains, gravity, and the way down. @param imu_hz  how often command() is called.
  PaperGuidance(const PaperControlParams& params, const GuidanceParams& ours, double filter_drag_x,
                double imu_hz);

  /// The command of this tick. A turn's own prediction goes on in `phase`.
  AttitudeCommand command(Phase& phase, const NavigationState& now, const Course& course);

  void reset() { altitude_.reset(), landing_.reset(); }

  /// Pictures count on straights only.
  [[nodiscard]] bool uses_pictures(const Phase& phase) const {
    return std::holds_alternative<TakeOff>(phase) || std::holds_alternative<Straight>(phase);
  }

  /// The gate is passed and the heading is not yet the next one's.
  [[nodiscard]] bool turn_ahead(const NavigationState& now, const Course& course) const;

  /// Speed a turn begins with: the mean of what drag said [m/s].
  [[nodiscard]] double entry_speed(const NavigationState&) const { return mean_speed_; }

  /// Not foreseen: the paper does not go around.
  [[nodiscard]] double lateral_at_gate(const NavigationState&, const Course&) const { return 0.0; }

 private:
  AttitudeCommand straight(const NavigationState& now, const Course& course) const;
  AttitudeCommand turn(Arc& arc, const NavigationState& now, const Course& course) const;
  void measure_speed(const NavigationState& now);

  PaperControlParams params_;
  LateralParams lateral_;
  AltitudeParams altitude_params_;
  double gravity_;
  double speed_scale_;  ///< The filter's k_x / speed_drag.
  Guidance landing_;
  Altitude altitude_;
  std::vector<double> speeds_;  ///< The last `speed_time` [m/s], a ring.
  std::size_t samples_ = 0;
  double mean_speed_ = 0.0;
};

}  // namespace gatefly
