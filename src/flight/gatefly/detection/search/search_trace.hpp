// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/frame_fit.hpp"
#include "gatefly/detection/search/gate_templates.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {

/// Trace of the careful search, to explain a missed gate. Quads are of the bars'
/// middle lines [px].
struct SearchTrace {
  /// A place that a template found, and the frame that was pulled onto the evidence there.
  struct Place {
    Quad template_px{}, frame_px{};
    FrameScore score;
    bool has_shape = false;  ///< The frame can be a picture of a square.
  };
  /// A frame that was looked at pixel by pixel.
  struct Finished {
    Quad rough_px{}, frame_px{};  ///< Before and after.
    FrameScore score;
    bool taken = false;
  };

  FixedList<Place, GateCandidates::kCapacity> places;  ///< The best template first.
  FixedList<Finished, 8> finished;                     ///< The best rough frame first.
  double least_rough = 0.0;  ///< Score of a place that is looked at pixel by pixel.
};

}  // namespace gatefly
