// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/race/race_params.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly {

/// A straight or an arc on the floor plan.
struct Segment {
  Eigen::Vector2d start{0, 0};  ///< [m]
  double heading = 0.0;         ///< At the start [rad].
  double curvature = 0.0;       ///< 1/radius, > 0 turns right; 0 is straight [1/m].
  double length = 0.0;          ///< [m]
};

/// A place on a path and which way it goes there.
struct PathPoint {
  Eigen::Vector2d position{0, 0};
  double heading = 0.0;
  double curvature = 0.0;
};

/// A height to be at, so far along a path.
struct Level {
  double s = 0.0;  ///< Metres along the path.
  double z = 0.0;  ///< Down [m].
};

/// Height reference at a place of a path: z down, and its slope along the way flown.
struct PathHeight {
  double z = 0.0;      ///< [m]
  double slope = 0.0;  ///< dz/ds: metres down a metre of way.
};

/// A place where a path has no room for a turn: stand still, turn, change the height, go on.
struct Stop {
  double s = 0.0;        ///< Metres along the path.
  double heading = 0.0;  ///< To leave with [rad].
  double z = 0.0;        ///< And the height to leave at, down [m].
};

/// The way from one gate to the next: straight, arc, straight, arc, straight; any of them may be
/// missing. One around things has more of them, and may have stops.
struct Path {
  FixedList<Segment, 17> segments;
  /// Held before the first and after the last; in between a smooth ramp. Two at one place: a stop.
  FixedList<Level, 17> levels;
  FixedList<Stop, 9> stops;  ///< In order.

  [[nodiscard]] double length() const;
  /// The point `s` metres along; straight on beyond both ends.
  [[nodiscard]] PathPoint at(double s) const;
  /// Metres along the path of the point nearest to `position` among s in [from, to].
  [[nodiscard]] double nearest(const Eigen::Vector2d& position, double from, double to) const;
  /// Height to fly at `s`.
  [[nodiscard]] PathHeight height_at(double s) const;
  [[nodiscard]] double z_at(double s) const { return height_at(s).z; }  ///< [m, down]

  /// From one height to another in one ramp that is done before the last metre and a half. The
  /// segments are there already.
  void climb(double z_from, double z_to);
};

/// The end of a segment.
[[nodiscard]] PathPoint point_on(const Segment& segment, double s);

struct PlanParams {
  double speed = 2.0;        ///< Wanted on straights [m/s]. [ours; paper: 1.5-1.8]
  double max_lateral = 3.2;  ///< v²/r an arc may ask for [m/s²]: 18° of roll. [estimate]
  Braking braking = {};
  double min_radius = 0.7;  ///< [m] [Li18 code: 0.9]
  /// From the body's outline to anything solid [m]. [docs/simulation.md]
  double clearance = 0.35;
  /// ... and where a leg has no such way, at least. [ours: a gate's own opening leaves 0.25]
  double least_clearance = 0.27;
  double body_radius = 0.20;  ///< Half the Bebop's width with guards [m].
  /// Straight before a gate that is wanted at least [m]; [Li18 §4: a margin of 2 m]
  double run_in = 2.5;
};

/// The radius beyond which an arc is no faster, half as much again [m].
[[nodiscard]] double widest_radius(const PlanParams& params);
/// Way before the gate that is left to come onto its axis [m]: the last straight, and of a turn before it that is gentle at this speed
/// [m/s] the part from which the gate is ahead.
[[nodiscard]] double way_to_settle(const Path& path, double speed, double max_lateral);
/// Straight before a gate that is wanted: longer for a fast drone, the time to come onto the axis
/// being the same [m].
[[nodiscard]] double wanted_run_in(const PlanParams& params);

/// The legs of a race: start to first gate, then gate to gate; the last leg of a lap leads to its
/// first gate.
struct RacePlan {
  Path start;              ///< From the pad to gate 0.
  std::vector<Path> legs;  ///< legs[i]: from gate i to gate (i + 1) % n.
  /// Speed at which each gate may be passed, lest the turns behind it come too soon [m/s]. Empty: any.
  std::vector<double> gate_speed;
  /// On each gate's axis, so far before it there is room to stand [m]. Empty: not known.
  std::vector<double> room_before;
  /// From the body's outline on its way to anything solid, one value for each kRoomStep: the start's
  /// way, then the legs' [m]. Empty: not known.
  std::vector<std::vector<double>> room_beside;
};

constexpr double kRoomStep = 0.5;  ///< Spacing of RacePlan::room_beside [m].

/// Plans all legs: straight out of a gate, at most two arcs (Dubins), straight into the next; where
/// that is not free, around, over or under what stands there (way_round.hpp).
///
/// Searches run-out, run-in and radius; prefers short ways with a long run-in and wide arcs; keeps
/// `clearance` to obstacles, walls and the frames of all gates, beside, above and below. Start-up
/// only: allocates and throws.
/// @throws std::invalid_argument naming the leg for which there is no way, and which gap is too
///     narrow by how much.
[[nodiscard]] RacePlan plan_race(const Track& track, const PlanParams& params);

/// Planned speed on a segment [m/s].
[[nodiscard]] double speed_on(const Segment& segment, const PlanParams& params);

/// Distance to the nearest solid thing, and its name.
struct Clearance {
  double distance = 0.0;  ///< From the body's outline; negative: touches [m].
  std::string nearest;    ///< "a wall", "obstacle 2", "gate 1".
};

/// How near a leg comes to anything solid, as the planner measures it. @param from_gate  -1: the start.
[[nodiscard]] Clearance clearance_of(const Path& path, const Track& track, const PlanParams& params,
                                     int from_gate, int to_gate);

}  // namespace gatefly
