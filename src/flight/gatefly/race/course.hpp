// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/estimation/navigator.hpp"
#include "gatefly/race/path.hpp"
#include "gatefly/race/phase.hpp"
#include "gatefly/race/race_params.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly {

/// How far along the race the drone is: which gate is next, the way there, the progress on it.
///
/// Li18 §2: gates in a fixed order. Plain bookkeeping over a plan; no clock, no estimator.
class Course {
 public:
  /// Plans the way. @throws std::invalid_argument when the track cannot be flown, saying why.
  Course(const Track& track, const PlanParams& plan, const CourseParams& params = {});

  /// Legs by each gate's `exit` (plan_from_exits), as the paper flies: a gate is passed at its turn
  /// point. @throws std::invalid_argument saying which exit is missing or wrong.
  [[nodiscard]] static Course by_exits(const Track& track, const CourseParams& params = {});

  /// Takes in where the drone is. True when it has passed a gate and is now after another one.
  bool follow(const NavigationState& now, const Phase& phase);

  /// From where it waited the drone flies straight on along the gate's axis: the leg's own way may
  /// end in an arc.
  void approach_straight(const NavigationState& now);

  /// The turn is done: the drone is where the leg's last straight begins, or so the plan says.
  void begin_approach();
  /// By exits: passed a gate, and the turn to the next one is not done.
  [[nodiscard]] bool before_approach() const { return before_approach_; }
  /// By exits: how far before the gate the leg's last straight begins [m]; nullopt when planned.
  [[nodiscard]] std::optional<double> approach_length() const;
  /// By exits: where the leg's turn ends, by the plan [m].
  [[nodiscard]] Eigen::Vector2d turn_end() const;

  [[nodiscard]] const MapGate& gate() const;  ///< The one to fly through next.
  [[nodiscard]] int target() const { return target_; }
  [[nodiscard]] int passed() const { return passed_; }
  [[nodiscard]] bool finished() const { return passed_ >= total_; }
  /// Finished, and clear of the last gate: a piece of the way behind it is flown, where there is one.
  [[nodiscard]] bool ran_out() const;
  [[nodiscard]] const Path& path() const;                      ///< To the target.
  [[nodiscard]] double progress() const { return progress_; }  ///< Metres along path().
  /// The next stop on path(); null: none.
  [[nodiscard]] const Stop* stop() const;
  /// Metres along path() that far on, but not beyond the next stop.
  [[nodiscard]] double ahead(double distance) const;
  /// Speed at which the next gate may be passed [m/s].
  [[nodiscard]] double gate_speed() const;
  /// On the next gate's axis, so far before it there is room to stand and wait [m].
  [[nodiscard]] double room_before() const;
  /// From the body's outline to anything solid, at the narrowest place of the next `distance` [m].
  [[nodiscard]] double room_beside(double distance) const;
  [[nodiscard]] double to_go() const { return path().length() - progress_; }
  [[nodiscard]] const RacePlan& plan() const { return plan_; }
  [[nodiscard]] const Track& track() const { return track_; }

 private:
  Course(const Track& track, RacePlan plan, const CourseParams& params);
  bool pass_gate();
  /// There is a planned way behind the last gate.
  [[nodiscard]] bool leads_on() const;
  [[nodiscard]] bool has_stopped(const Stop& stop, const NavigationState& now) const;

  Track track_;
  CourseParams params_;
  RacePlan plan_;
  std::optional<Path> approach_;  ///< Instead of the leg's own way, after a search.
  bool by_exits_ = false, before_approach_ = false;
  int total_ = 0, target_ = 0, passed_ = 0;
  double progress_ = 0.0;
  double left_ = 0.0;           ///< The last stop that it has gone on from [m along path()].
  std::size_t stops_done_ = 0;  ///< Stops of path() that it has gone on from.
};

/// The frame of a gate of the map.
[[nodiscard]] inline GateFrame frame_of(const MapGate& gate) { return {gate.p_EG, gate.yaw_EG}; }

}  // namespace gatefly
