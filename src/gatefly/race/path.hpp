// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/geometry/fixed_list.hpp"
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

/// The way from one gate to the next: straight, arc, straight, arc, straight; any of them may be
/// missing.
struct Path {
  FixedList<Segment, 5> segments;
  double z_start = 0.0, z_end = 0.0;  ///< Heights of its two ends, z down [m].

  [[nodiscard]] double length() const;
  /// The point `s` metres along; straight on beyond both ends.
  [[nodiscard]] PathPoint at(double s) const;
  /// Metres along the path of the point nearest to `position` among s in [from, to].
  [[nodiscard]] double nearest(const Eigen::Vector2d& position, double from, double to) const;
  /// Height to fly at `s` [m, down]: a smooth ramp that is done before the last metre and a half.
  [[nodiscard]] double z_at(double s) const;
};

/// The end of a segment.
[[nodiscard]] PathPoint point_on(const Segment& segment, double s);

struct PlanParams {
  double speed = 1.7;        ///< Wanted on straights [m/s]. [paper: 1.5-1.8]
  double max_lateral = 3.2;  ///< v²/r an arc may ask for [m/s²]: 18° of roll. [ours]
  double min_radius = 0.7;   ///< [m] [Li18 code: 0.9]
  /// From the body's outline to anything solid [m]. [docs/simulation.md]
  double clearance = 0.35;
  double body_radius = 0.20;  ///< Half the Bebop's width with guards [m].
  /// Straight before a gate that is wanted [m]; [Li18 §4: a margin of 2 m]
  double run_in = 2.5;
};

/// The legs of a race: start to first gate, then gate to gate; the last leg of a lap leads to its
/// first gate.
struct RacePlan {
  Path start;              ///< From the pad to gate 0.
  std::vector<Path> legs;  ///< legs[i]: from gate i to gate (i + 1) % n.
};

/// Plans all legs: straight out of a gate, at most two arcs (Dubins), straight into the next.
///
/// Searches run-out, run-in and radius; prefers short ways with a long run-in and wide arcs; keeps
/// `clearance` to obstacles, walls and the frames of all gates. Start-up only: allocates and
/// throws.
/// @throws std::invalid_argument naming the leg for which there is no way, and why.
[[nodiscard]] RacePlan plan_race(const Track& track, const PlanParams& params);

/// What a plan wants to fly on a segment [m/s].
[[nodiscard]] double speed_on(const Segment& segment, const PlanParams& params);

/// What a way comes nearest to.
struct Clearance {
  double distance = 0.0;  ///< From the body's outline; negative: touches [m].
  std::string nearest;    ///< "a wall", "obstacle 2", "gate 1".
};

/// How near a leg comes to anything solid, as the planner measures it. @param from_gate  -1: the start.
[[nodiscard]] Clearance clearance_of(const Path& path, const Track& track, const PlanParams& params,
                                     int from_gate, int to_gate);

}  // namespace gatefly
