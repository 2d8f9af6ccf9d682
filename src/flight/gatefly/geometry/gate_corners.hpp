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

/// A corner belongs to the frame, seen against what is behind it, or to the opening in it.
enum class CornerOf { kFrame, kOpening };

/// How far from its place on the near face a corner of boards shows, in the gate's frame [m]. [ours]
///
/// A board has a depth, and its outline is what shows. The outline of the frame is the edge of its
/// near face, or of its far face where the eye is beyond that edge; that of the opening the other way
/// round. The corner is where the outlines of its two edges cross. At 5 m from a board of 8 cm, 40
/// degrees aside, this is 5 px of 425 a radian.
/// @param corner_G  in the middle of the boards. @param eye_G  x < 0: before the gate.
[[nodiscard]] inline Eigen::Vector3d outline_shift_G(const Eigen::Vector3d& corner_G,
                                                     const Eigen::Vector3d& eye_G, double near_face,
                                                     CornerOf of) {
  if (near_face == 0.0) return Eigen::Vector3d::Zero();
  const auto face = [&](double edge, double eye) {
    const bool is_beyond = eye * edge > edge * edge;
    return is_beyond == (of == CornerOf::kFrame) ? near_face : -near_face;
  };
  const double upright = face(corner_G.y(), eye_G.y()), level = face(corner_G.z(), eye_G.z());
  const double farther = (upright - eye_G.x()) / std::max(1e-3, level - eye_G.x());
  return {upright + near_face, 0.0, (corner_G.z() - eye_G.z()) * (farther - 1.0)};
}

}  // namespace gatefly
