// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "gatefly/detection/quad.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {

/// How a gate was found: along its bars, or by trying frames everywhere.
enum class DetectionMethod { kSnake, kFrames };

/// What every detector answers with.
struct GateDetection {
  Quad corners_px{};     ///< Outer corners, sub-pixel; clockwise from top-left.
  double fitness = 0.0;  ///< 0..1. Careful search: part of such frames that were gates; paper's: cf, Eq. (1).
  std::array<double, 4> corner_fitness{1.0, 1.0, 1.0, 1.0};  ///< 0..1; 0 for what is not in the picture.
  DetectionMethod method = DetectionMethod::kSnake;
  bool whole = true;     ///< All four bars are in the picture; else corners outside are a guess.
};

/// Distinct gates of one picture, best first.
using GateDetections = FixedList<GateDetection, 6>;

}  // namespace gatefly
