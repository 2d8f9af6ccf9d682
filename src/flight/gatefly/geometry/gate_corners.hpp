// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>

namespace gatefly {

/// Corners of a square gate in its own frame G, as seen by who flies through it: TL, TR, BR, BL [m].
[[nodiscard]] inline std::array<Eigen::Vector3d, 4> gate_corners_G(double side) {
  const double h = 0.5 * side;
  return {{{0, -h, -h}, {0, h, -h}, {0, h, h}, {0, -h, h}}};
}

/// Bars as wide as this, of their gate's outer side, are boards: their corners come from their edges.
/// [Washington's chequered bars, 0.15, are found better by their middle lines]
inline constexpr double kLeastBoard = 0.2;

/// How deep a gate's bars are, along the way through it, where nobody says: square, and boards 0.10
/// [m]. [estimate]
[[nodiscard]] inline double usual_depth(double bar) { return std::min(bar, 0.10); }

/// How far before the middle of a gate, towards who looks at it, its corners are seen [m]: those of
/// boards on their near face. What shows of a thin bar has its axis in its middle.
[[nodiscard]] inline double near_face(double side, double bar, double depth) {
  return bar >= kLeastBoard * side ? 0.5 * depth : 0.0;
}

}  // namespace gatefly
