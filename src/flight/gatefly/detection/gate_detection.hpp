// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"
#include "gatefly/geometry/exponential.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {

/// How a gate was found: along its bars, by trying frames everywhere, by two side bars that the
/// border cuts, or by its opening, whose corners are the detection's then.
enum class DetectionMethod { kSnake, kFrames, kBars, kOpening };

/// A detected gate; the answer of every detector.
struct GateDetection {
  /// Outer corners, sub-pixel; clockwise from top-left.
  Quad corners_px{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                  Eigen::Vector2d::Zero()};
  /// 0..1. Careful search: part of such frames that were gates; paper's: cf, Eq. (1).
  double fitness = 0.0;
  /// 0..1; 0 for what is not in the picture.
  std::array<double, 4> corner_fitness{1.0, 1.0, 1.0, 1.0};
  DetectionMethod method = DetectionMethod::kSnake;
  bool whole = true;  ///< All four bars are in the picture; else corners outside are a guess.
};

/// Distinct gates of one picture, best first.
using GateDetections = FixedList<GateDetection, 6>;

/// Openings of near gates, largest first: `corners_px` are the opening's, those in view have a
/// fitness.
using Openings = FixedList<GateDetection, 3>;

/// Fitness of a frame with this score: part of such frames that were gates, on the authors' labelled
/// pictures.
[[nodiscard]] inline double confidence_of(double score) {
  return 1.0 / (1.0 + gatefly::exp(-2.2 * (score - 2.45)));
}
/// Back from a confidence.
[[nodiscard]] inline double score_of(double confidence) {
  return 2.45 + gatefly::log(confidence / (1.0 - confidence)) / 2.2;
}

/// The lower corners of a gate: all that is needed of one whose upper bar is above the picture.
struct LowerCorners {
  Eigen::Vector2d bottom_left_px, bottom_right_px;  ///< Outer corners, sub-pixel.
  double fitness = 0.0;                             ///< Fitness of the bars in view, 0..1.
};

/// The two side bars of a gate that no longer fits into the picture.
struct GateBars {
  /// On the middle line of each bar, halfway along what is in view.
  Eigen::Vector2d left_px, right_px;
};

/// A gate that the border cuts: two side bars, and what else of it is in the picture.
struct GatePart {
  /// `whole` is false; a corner of fitness 0 is not in view: there its bar leaves the picture.
  GateDetection gate;
  GateBars bars;

  /// The lower corners, when both are in view.
  [[nodiscard]] std::optional<LowerCorners> lower_corners() const {
    if (!(gate.corner_fitness[2] > 0.0 && gate.corner_fitness[3] > 0.0)) return std::nullopt;
    return LowerCorners{gate.corners_px[3], gate.corners_px[2], gate.fitness};
  }
};

}  // namespace gatefly
