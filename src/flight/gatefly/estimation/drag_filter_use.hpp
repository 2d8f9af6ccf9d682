// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

namespace gatefly {

/// How the drag filter takes what it is told. The defaults are ours. [docs/paper/deviations.md]
struct DragFilterUse {
  /// A fix is fused where the filter was when the picture was exposed; else as of now.
  bool looks_back = true;
  /// Errors that last a whole leg are in its covariance: the map's, the heading's. A blind leg then
  /// teaches the heading, and many refusals restart the filter.
  bool knows_lasting_errors = true;
  /// It starts with the accelerometer's bias from the rest; else with 0.
  bool takes_rest_bias = true;
  /// Speed control gets the velocity observer's output; else Eq. (14) as it is, vibration included.
  bool observes_velocity = true;
  /// Square roots of R in place of each fix's own covariance; z is then the altimeter's alone [m].
  std::optional<Eigen::Vector3d> fix_sigma;
  /// Standard deviation of x and y that each leg begins anew with [m]; without, it goes on with its own.
  std::optional<double> leg_sigma;
};

/// Li18's filter, where it is not a number of DragFilterParams. [Li18 flight code, March 2018]
struct PaperFilterParams {
  Eigen::Vector3d fix_sigma{1.05, 0.32, 0.71};  ///< Square roots of R; z is not used [m].
  double leg_sigma = 1.0;  ///< Standard deviation of x and y where a leg begins [m].
};

/// Li18's use of the filter: a fix counts as of now, with a fixed covariance. [Li18 §3.3]
[[nodiscard]] inline DragFilterUse use_of_paper(const PaperFilterParams& paper = {}) {
  return {.looks_back = false,
          .knows_lasting_errors = false,
          .takes_rest_bias = false,
          .observes_velocity = false,
          .fix_sigma = paper.fix_sigma,
          .leg_sigma = paper.leg_sigma};
}

}  // namespace gatefly
