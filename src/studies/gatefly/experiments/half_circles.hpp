// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gatefly/experiments/blind_arc.hpp"
#include "gatefly/experiments/smooth_motion.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {

/// Rule for a blind half circle seen from outside. All [ours, estimate] but where it says so.
struct HalfCircleRule {
  /// It turns: half of the planned v / r = 1.6 / 1.5 rad/s.
  double turning = 30.0 * kDegree;
  double min_time = 1.0;    ///< Turning at least so long [s]: no gust, no correction.
  double max_pause = 0.15;  ///< Slower for so long is still the same turn [s].
  /// It has begun where the yaw rate last rose through this part of its median in the turn: the
  /// commanded heading has begun to move; the body follows it by some hundredths of a second.
  double begin_part = 0.1;
  /// It ends within this of the opposite heading, by the nose. [authors: 3°]
  double end_within = 3.0 * kDegree;
  double straight_before = 0.5;            ///< Heading held for so long before it [s] ...
  double straight_after = 0.3;             ///< ... and after it [s].
  double held_within = 5.0 * kDegree;      ///< Held means, before:
  double settled_within = 12.0 * kDegree;  ///< ... after: the heading overshoots by some degrees.
  double max_climb = 0.3;                  ///< Level: height within this of the entry's [m].
  double min_speed = 1.0;                  ///< [m/s]
  /// Entered straight: course against heading. Farther is no end of a straight.
  double max_entry_slip = 15.0 * kDegree;
  double min_tracked = 0.95;  ///< Part of the samples from straight to straight.
};

/// A turn that is no blind half circle, and why.
struct LeftOut {
  double begin = 0.0, end = 0.0;  ///< [s]
  std::string reason;
};

struct HalfCircles {
  std::vector<BlindArc> arcs;  ///< Without the flight's name.
  std::vector<LeftOut> left_out;
};

/// All half circles of a flight by the rule: heading turns by 180° between two straights, level, to
/// either side.
[[nodiscard]] HalfCircles find_half_circles(std::span<const SmoothSample> motion,
                                            const HalfCircleRule& rule = {});

/// The arc between two moments of a motion, whatever decided where it begins and ends.
/// @param heading  of the straight before it [rad].
[[nodiscard]] BlindArc arc_between(std::span<const SmoothSample> motion, double begin, double end,
                                   double heading, bool right, const PlannedArc& planned = {});

}  // namespace gatefly::experiments
