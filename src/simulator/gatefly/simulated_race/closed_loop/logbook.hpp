// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/referee.hpp"
#include "gatefly/simulated_race/closed_loop/consistency.hpp"
#include "gatefly/simulated_race/closed_loop/discoveries.hpp"
#include "gatefly/simulated_race/closed_loop/loss_watch.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"
#include "gatefly/simulated_race/closed_loop/scorer.hpp"

namespace gatefly::simulated_race {

/// Collects what a race's result says: the way flown, what was seen, what was believed.
class Logbook {
 public:
  explicit Logbook(const RaceConfig& config)
      : scorer_{config.sim.world, config.sim.camera},
        consistency_{config.sim.world.gates, config.pilot.track},
        discoveries_{config.pilot, config.sim},
        loss_{config.sim.world, config.pilot.track},
        gates_per_lap_{config.sim.world.gates.size()} {}

  /// A step of the body. @param racing  the last gate is still ahead.
  void moved(const sim::BodyState& state, double dt, bool racing);
  void passed(const sim::GatePass& pass);
  /// A tick of the pilot.
  void flown(const Pilot& pilot, const sim::BodyState& truth, double now, bool racing);
  /// One in which a picture arrived, exposed around `pose`.
  void looked(const Pilot& pilot, const sim::BodyPose& pose, const sim::Sight& sight);
  void motors(const Command& command, double now);

  /// Corners of the next gate in the last picture: Scorer::wanted().
  [[nodiscard]] const std::optional<Quad>& next_gate() const { return scorer_.wanted(); }

  void fill(RaceResult& result) const;
  /// The reason; only for a race that ended unfinished.
  [[nodiscard]] WhyLost why_lost(const Pilot& pilot, const RaceResult& result) const;

 private:
  Scorer scorer_;
  ConsistencyWatch consistency_;
  DiscoveryWatch discoveries_;
  LossWatch loss_;
  std::size_t gates_per_lap_;
  std::vector<sim::GatePass> passes_;
  double path_since_first_ = 0.0, path_at_last_ = 0.0, max_speed_ = 0.0;
  Eigen::Vector3d error2_ = Eigen::Vector3d::Zero();
  int error_count_ = 0, searches_ = 0;
  bool was_searching_ = false, has_looked_ = false;
  double motors_on_ = -1.0;
};

}  // namespace gatefly::simulated_race
