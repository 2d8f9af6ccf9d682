// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "gatefly/race/pilot.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/simulated_race/closed_loop/error_ledger.hpp"
#include "gatefly/simulated_race/closed_loop/scorer.hpp"
#include "gatefly/simulated_race/closed_loop/why_lost.hpp"

namespace gatefly::simulated_race {

/// Keeps while a race goes on what is needed to say why it was lost.
class LossWatch {
 public:
  LossWatch(const world::World& world, const Track& map) : world_{world}, map_{map} {}

  /// A tick of the pilot. @param looked  it has just looked at a picture, with which result so far.
  /// @param passed  gates, by the referee.
  void update(const Pilot& pilot, const sim::BodyState& truth, double now, int passed,
              const Scorer* looked);

  /// Names the last sighting's gate when it was not the target: "gate 2", "no gate".
  void taken_of(const std::string& what) { taken_of_ = what; }

  /// @param contact  what was touched, as physics calls it; "" for nothing.
  [[nodiscard]] WhyLost why(const Pilot& pilot, const std::string& stop_reason,
                            const std::string& contact) const;

 private:
  void note_sighting(const Pilot& pilot, const Scorer& looked);
  void keep_turning_points(const Pilot& pilot);
  [[nodiscard]] Eigen::Vector3d map_shift(int gate) const;

  world::World world_;
  Track map_;
  ErrorLedger ledger_;
  LossMoment now_;
  /// When the pilot counted a gate that the referee did not, and when it gave up.
  std::optional<LossMoment> miscounted_, given_up_;
  LooksSinceFix at_fix_;
  std::string taken_of_;
  double wind_sum_ = 0.0;
  int ticks_ = 0;
};

}  // namespace gatefly::simulated_race
