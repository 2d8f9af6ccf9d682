// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace gatefly::experiments {

/// How the roll follows its command: a second-order lag, started level and at rest.
struct RollLag {
  double omega = 0.0;  ///< Natural frequency [rad/s]; 0: the roll is what is commanded.
  double zeta = 1.0;   ///< Damping.
};

/// A drone that flies past a line at constant forward speed and rolls back onto it. Li18 Eq. (30).
struct LateralLoop {
  std::function<double(double y, double v_y)> roll_command;  ///< [rad], of [m] and [m/s].
  RollLag lag = {};
  double k_y = -0.47;  ///< Drag sideways [1/s]. [Li18 code]
};

/// A law of the study, by name.
struct LateralLaw {
  std::string key, name;
  LateralLoop loop;
};
/// The paper's as printed, as flown with and without lag, ours.
[[nodiscard]] std::vector<LateralLaw> lateral_laws();

/// Between samples of a course [s].
inline constexpr double kLateralStep = 1e-3;

/// y over time [m], a sample each kLateralStep from 0 to `duration` [s]; v_y starts at 0.
///
/// Source: Li18 Eq. (30), v̇_y = g tan φ + k_y v_y.      Differs: docs/paper/deviations.md#eq-30
[[nodiscard]] std::vector<double> lateral_course(const LateralLoop& loop, double y0,
                                                 double duration);

/// From where an opening can be flown through, by the time that is left to its plane.
///
/// v_x is constant, so all starts with one y0 share one course: what counts is distance / v_x.
/// Sign: left is right mirrored, for all laws here; only y0 >= 0 is flown.
class FeasibleSet {
 public:
  /// Flies the courses from y0 = 0 to `widest` [m].
  FeasibleSet(const LateralLoop& loop, double widest, double duration);

  /// y in the plane of the opening [m], started |y0| <= widest beside its axis.
  [[nodiscard]] double offset(double time, double y0) const;
  /// Offset at which passing ends or begins again as y0 grows.
  struct Edge {
    double y0 = 0.0;        ///< [m]
    bool overshot = false;  ///< The bar on the other side is met, else the one on this side.
  };
  /// In the order of y0: the first ends what passes, the second lets pass again.
  [[nodiscard]] std::vector<Edge> edges(double time, double half_opening) const;
  /// The largest y0 up to which every start ends within `half_opening` [m]; at most `widest`.
  [[nodiscard]] double boundary(double time, double half_opening) const;
  /// Time from which on a start at y0 is within `half_opening`, up to the end of the courses [s];
  /// NaN when it is not even there.
  [[nodiscard]] double time_needed(double y0, double half_opening) const;

 private:
  [[nodiscard]] double at(std::size_t course, double time) const;

  double widest_;
  std::vector<std::vector<double>> courses_;  ///< By y0, evenly from 0 to widest_.
};

}  // namespace gatefly::experiments
