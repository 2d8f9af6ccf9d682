// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/search/board_edges.hpp"
#include "gatefly/detection/search/frame.hpp"

namespace gatefly {

/// A frame as a detection, with the corners that are meant: from the middle lines of thin bars, from
/// the outer edges of boards. [ours]
/// @param frame  its middle lines, sub-pixel.
[[nodiscard]] inline GateDetection meant_detection(Frame frame, DetectionMethod method,
                                                   const Image& image,
                                                   const GateDetectorParams& params,
                                                   const SideCurves& curves) {
  double meant = params.corner_scale;
  if (params.has_boards()) {
    const double board_px = params.bar() * std::sqrt(std::abs(area(frame.quad)));
    const BoardEdges edges = board_edges(image, frame.quad, board_px, curves);
    frame.quad = edges.corners;
    meant *= 1.0 - params.bar_ratio;
    for (std::size_t k = 0; k < 4; ++k) frame.unseen[k] = !edges.has(k);
  }
  return detection_of(frame, curves.scaled(frame.quad, meant), method, image);
}

}  // namespace gatefly
