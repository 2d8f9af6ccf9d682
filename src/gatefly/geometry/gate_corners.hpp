// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

namespace gatefly {

/// Corners of a square gate in its own frame G, as seen by who flies through it: TL, TR, BR, BL [m].
[[nodiscard]] inline std::array<Eigen::Vector3d, 4> gate_corners_G(double side) {
  const double h = 0.5 * side;
  return {{{0, -h, -h}, {0, h, -h}, {0, h, h}, {0, -h, h}}};
}

}  // namespace gatefly
