// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace gatefly::experiments {

/// The half circle that Li18 §4 plans.
struct PlannedArc {
  double radius = 1.5;  ///< [m] [Li18 §4]
};

/// Why an arc does not end where it was planned: parts of the difference, in the entry's frame, that
/// add up to it. Exact kinematics, for whatever is flown: displacement = ∫ v (cos χ, sin χ) dt.
struct ArcParts {
  /// The nose stops short of 180°, on the planned circle [m].
  Eigen::Vector2d early_end = Eigen::Vector2d::Zero();
  /// The nose follows the command late: the way at the commanded speed meanwhile [m].
  Eigen::Vector2d late_nose = Eigen::Vector2d::Zero();
  /// The true speed is not that which the yaw rate stands for [m].
  Eigen::Vector2d speed = Eigen::Vector2d::Zero();
  /// The course is not where the nose is [m].
  Eigen::Vector2d slip = Eigen::Vector2d::Zero();
};

/// Quantities that only the simulator knows: where the lanes are, the pilot's belief.
struct SimulatedDetail {
  double predicted_speed = 0.0;  ///< That the arc's own prediction began with [m/s].
  /// Entry and exit from the gate before the arc, along its lane [m].
  Eigen::Vector2d entry_at_gate = Eigen::Vector2d::Zero();
  Eigen::Vector2d exit_at_gate = Eigen::Vector2d::Zero();
  /// Estimate - truth, both of the next gate, when it is first seen and half a second later: what
  /// jumps in Li18 Fig. "jump after arc" [m].
  Eigen::Vector2d error_before = Eigen::Vector2d::Zero();
  Eigen::Vector2d error_after = Eigen::Vector2d::Zero();
  double blind = 0.0;  ///< From the arc's end to that first sighting [s].
};

/// A blind half circle, recorded or simulated. Horizontal vectors are (north, east) of a frame E.
struct BlindArc {
  std::string flight;             ///< A take's name, or how the simulator was set.
  bool right = true;              ///< The turn goes clockwise, seen from above.
  double begin = 0.0, end = 0.0;  ///< [s]
  Eigen::Vector2d entry = Eigen::Vector2d::Zero(), exit = Eigen::Vector2d::Zero();      ///< [m]
  Eigen::Vector2d v_entry = Eigen::Vector2d::Zero(), v_exit = Eigen::Vector2d::Zero();  ///< [m/s]
  double heading = 0.0;     ///< The nose on the straight before the arc [rad].
  double mean_pitch = 0.0;  ///< Inside the arc; nose up is positive [rad].
  double mean_climb = 0.0;  ///< Mean height above the entry's [m].
  double max_climb = 0.0;   ///< The largest height change, with its sign; up is positive [m].
  /// Speed of the nose, r times its rate: as the drone believes; and really [m/s].
  double believed_speed = 0.0, mean_speed = 0.0;
  ArcParts parts = {};
  double radius = 0.0;                         ///< Radius of the circle that fits best [m].
  std::vector<Eigen::Vector2d> path = {};      ///< From 0.5 s before to 0.5 s after it [m].
  std::optional<SimulatedDetail> detail = {};  ///< Simulated arcs only.

  [[nodiscard]] double duration() const { return end - begin; }
  [[nodiscard]] double entry_speed() const { return v_entry.norm(); }
  [[nodiscard]] double exit_speed() const { return v_exit.norm(); }
  /// A vector of E: x along the entry's heading, y towards the inside of the turn.
  [[nodiscard]] Eigen::Vector2d in_entry_frame(const Eigen::Vector2d& of_E) const;
  /// From entry to exit, in the entry's frame; planned: (0, 2 r) [m].
  [[nodiscard]] Eigen::Vector2d displacement() const { return in_entry_frame(exit - entry); }
  /// Course against the entry's heading; towards the inside of the turn is positive [rad].
  [[nodiscard]] double entry_slip() const;
  /// Course against the heading opposite to the entry's; positive: the course has turned farther.
  [[nodiscard]] double exit_slip() const;
};

/// Mean and sample standard deviation of one quantity; NaN where there are too few.
struct Spread1 {
  std::size_t count = 0;
  double mean = 0.0, deviation = 0.0;
};
[[nodiscard]] Spread1 spread_of(std::span<const double> values);

/// Mean and sample covariance of points in the plane.
struct Spread2 {
  std::size_t count = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();

  [[nodiscard]] Eigen::Vector2d deviation() const { return covariance.diagonal().cwiseSqrt(); }
};
[[nodiscard]] Spread2 spread_of(std::span<const Eigen::Vector2d> points);

/// One point of an arc, told apart by the arc's flight.
struct FlightPoint {
  std::string flight;
  Eigen::Vector2d point;
};

/// Standard deviations of points that come from several flights; NaN where there are too few.
struct FlightSpread {
  Eigen::Vector2d within = Eigen::Vector2d::Zero();   ///< About each flight's own mean.
  Eigen::Vector2d between = Eigen::Vector2d::Zero();  ///< Spread of these means.
};
[[nodiscard]] FlightSpread flight_spread(std::span<const FlightPoint> points);

/// The sample variance of `count` values after a row of zeros was left among them: how Li18's Table
/// "accuracy distribution" got its 0.8087 (docs/paper/deviations.md#table-2).
[[nodiscard]] double variance_with_zero_row(std::size_t count, double mean, double variance);

/// Radius of the circle nearest to the points, by Kåsa's linear least squares; NaN for fewer than
/// three points or a line.
[[nodiscard]] double fitted_radius(std::span<const Eigen::Vector2d> points);

}  // namespace gatefly::experiments
