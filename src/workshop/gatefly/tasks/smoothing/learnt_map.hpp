// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/tasks/smoothing/smoother.hpp"

namespace gatefly::smoothing {

/// One flight's word on the gates of its map, together: errors of the map, kPerGate a gate.
struct FlightMap {
  std::vector<eskf::Landmark> gates;  ///< As the map has them.
  Eigen::VectorXd errors;             ///< Found, against the map.
  Eigen::MatrixXd P;                  ///< Their covariance, which the map's own sigmas are part of.
  std::vector<bool> seen;             ///< In at least one picture.
};
[[nodiscard]] FlightMap map_of(const Smoothed& smoothed, const Intake& intake);

/// A gate as flights have learnt it.
struct LearntGate {
  eskf::GateBelief belief;
  eskf::GateSigmas sigmas = eskf::GateSigmas::Zero();  ///< One standard deviation each.
  bool seen = false;
};

struct LearntMap {
  std::vector<LearntGate> gates;
  /// How far each flight's own gates are from these in their place, greatest of all gates, in
  /// standard deviations: above 4 or so a gate was moved, or taken for another one.
  std::vector<double> worst;
};

/// Flights of one map, fused by their information with all correlations between gates.
///
/// The place of the gates as a whole is left as the map has it, north, east and heading: nothing but the
/// pad, which is set down by hand each time, says more. The sigmas are of gates within that frame
/// (inner constraints; Baarda 1973). Heights are above the floor, which every flight knows.
/// @param flights  at least one, of the same gates.
[[nodiscard]] LearntMap fused(std::span<const FlightMap> flights, const eskf::Priors& priors);

/// Errors of gates without what moves and turns all of them together.
/// @param information  of each error, as weights.
[[nodiscard]] Eigen::MatrixXd without_common(std::span<const eskf::Landmark> gates,
                                             const Eigen::VectorXd& information);

}  // namespace gatefly::smoothing
