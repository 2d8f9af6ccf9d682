// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/geometry/exponential.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// How well a frame lies on the evidence, each in nats of a mean sample.
struct FrameScore {
  double total = -9.0;
  double mean = 0.0, weakest = 0.0;  ///< Along the four sides; along the worst of them.
  /// Beside the sides and in the middle: a gate is empty there.
  double inside = 0.0, outside = 0.0;
  double beyond = 0.0;           ///< Evidence past the corners: a gate's bars end there.
  std::array<double, 4> side{};  ///< Top, right, bottom, left.
  double filled = 0.0;           ///< Taken off the total because the opening is none.

  void take_off(double lost) { filled += lost, total -= lost; }
};

/// Whether a quad can be a picture of a square frame: convex, no side much shorter than its
/// opposite.
[[nodiscard]] inline bool is_frame_shaped(const Quad& q, double least_side, double most_aspect) {
  double shortest = 1e9, longest = 0.0;
  std::array<double, 4> length{};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = q[(i + 1) % 4] - q[i], b = q[(i + 2) % 4] - q[(i + 1) % 4];
    length[i] = a.norm();
    shortest = std::min(shortest, length[i]), longest = std::max(longest, length[i]);
    if (!(a.x() * b.y() - a.y() * b.x() > 0.4 * a.norm() * b.norm())) return false;
  }
  const auto alike = [](double a, double b) { return a < 1.8 * b && b < 1.8 * a; };
  return alike(length[0], length[2]) && alike(length[1], length[3]) && shortest > least_side &&
         longest < most_aspect * shortest;
}

/// A frame that was fitted: the bars' middle lines.
struct Frame {
  Quad quad;
  FrameScore score;
  std::array<bool, 4> unseen = {};  // corners of which only the rough place is known
  int guess = -1;                   // of a lens that nobody named, which was tried; -1: straight
};

/// Part of corners within 6 px of their label, by the evidence along the weaker of their two sides,
/// on the authors' labelled pictures.
[[nodiscard]] inline double corner_confidence_of(double side) {
  return 1.0 / (1.0 + gatefly::exp(-0.5 - 1.6 * side));
}

/// A frame as it is reported: the corners that are meant, and confidences.
/// @param frame  a corner is seen where its own corner is in the picture.
[[nodiscard]] inline GateDetection detection_of(const Frame& frame, const Quad& corners,
                                                DetectionMethod method, const Image& image) {
  const Quad listed = clockwise_from_top_left(corners);
  const auto first = static_cast<std::size_t>(std::find(corners.begin(), corners.end(), listed[0]) -
                                              corners.begin());
  GateDetection gate{
      .corners_px = listed, .fitness = confidence_of(frame.score.total), .method = method};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t k = (first + i) % 4;
    const Eigen::Vector2d& p = frame.quad[k];
    const bool in_view = !frame.unseen[k] && p.x() >= 1.0 && p.y() >= 1.0 &&
                         p.x() <= image.width() - 2.0 && p.y() <= image.height() - 2.0;
    gate.corner_fitness[i] =
        in_view ? corner_confidence_of(std::min(frame.score.side[k], frame.score.side[(k + 3) % 4]))
                : 0.0;
    gate.whole = gate.whole && in_view;
  }
  return gate;
}

}  // namespace gatefly
