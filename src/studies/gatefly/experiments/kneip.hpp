// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"

namespace gatefly::experiments {

/// Choices left open when three corners allow up to four poses. The defaults give the curves of
/// Li18's authors.
struct KneipRule {
  bool complex_roots = true;  ///< Whether the real parts of complex roots are answers, too.
  /// Best is the least sum of squared errors of all four corners, else of their distances.
  bool squares = false;
  /// How many sets of three neighbours are tried; the first is TL TR BR.
  int triples = 4;
};

/// Place of the camera relative to a gate [m, frame G], by P3P as Kneip, Scaramuzza and Siegwart
/// 2011 have it. A baseline.
///
/// @param corners  TL TR BR BL, drawn by a straight lens of `focal_px` centred at the origin.
[[nodiscard]] std::optional<Eigen::Vector3d> camera_by_kneip(const Quad& corners, double focal_px,
                                                             double side,
                                                             const KneipRule& rule = {});

}  // namespace gatefly::experiments
