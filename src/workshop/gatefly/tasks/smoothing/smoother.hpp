// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "gatefly/tasks/smoothing/intake.hpp"

namespace gatefly::smoothing {

/// A map may be told to be exact, an inverse may not [m], [rad].
inline constexpr double kLeastPrior = 1e-4;

/// The belief at one moment by all that was measured, before it and after.
struct Moment {
  double time = 0.0;  ///< [s]
  eskf::Nominal x;    ///< Without gates and corners' errors.
};

/// How sure it is at a moment, all states; gates follow kGates in the landmarks' order.
struct Certainty {
  std::size_t moment = 0;  ///< Index of the path.
  Eigen::MatrixXd P;
};

struct Smoothed {
  std::vector<Moment> path;  ///< The start, then the end of every tick.
  std::vector<Certainty> certainties;
  std::vector<eskf::Landmark> landmarks;  ///< As the map has them ...
  std::vector<eskf::GateBelief> gates;    ///< ... as they were found ...
  Eigen::MatrixXd P_gates;                ///< ... and how sure that is.
  int passes = 0;
  bool settled = false;  ///< The last pass changed less than 1 mm and 0.01°.
};

struct SmootherParams {
  int most_passes = 20;
  double certainty_period = 0.125;  ///< Between two certainties [s].
};

/// The most probable flight, given all that the filter took in and its models: Gauss-Newton, each step a
/// Kalman filter forwards and its adjoint backwards (Bryson and Frazier 1963; Bell 1994).
///
/// Equations: docs/derivations/smoother.md. Takes some 10 kB a tick, 100 MB for 80 s of the showroom.
/// @param now_and_then  called often; may throw to stop; may be empty.
[[nodiscard]] Smoothed smooth(const Intake& intake, const SmootherParams& params = {},
                              const std::function<void()>& now_and_then = {});

/// The belief at any time, between the path's moments by a straight line; before and after, its ends.
[[nodiscard]] eskf::Nominal at(const Smoothed& smoothed, double time);

}  // namespace gatefly::smoothing
