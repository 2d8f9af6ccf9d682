// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/color_model.hpp"
#include "gatefly/detection/evidence_map.hpp"
#include "gatefly/detection/frame_fit.hpp"
#include "gatefly/detection/gate_templates.hpp"
#include "gatefly/detection/gate_detection.hpp"

namespace gatefly {

struct CarefulSearchParams {
  double max_roll_deg = 60.0;
  double min_score = 2.5;     ///< Of FrameScore::total: one in two such frames is a gate. [docs/paper/results.md]
  double max_inside = 0.5;    ///< Evidence in the opening [nats]: a filled square is no gate.
  double min_side_px = 10.0;  ///< Of the bars' centre lines.
  double max_aspect = 3.2;
  double corner_scale = 1.0 / 0.95;  ///< From the bars' middle lines to the corners that are meant: outer ones.
  FrameWeights weights;
};

/// Finds washed-out, blurred and turned gates: evidence everywhere, frames of every size and turn tried
/// everywhere, the best ones fitted. [ours; Li18 has no counterpart.]
class CarefulSearch {
 public:
  explicit CarefulSearch(const CarefulSearchParams& params = {}) : params_{params} {}

  /// Distinct gates, best first. Allocates nothing.
  [[nodiscard]] GateDetections detect(const Image& image, const ColorModel& color);

 private:
  CarefulSearchParams params_;
  EvidenceMap map_;
  GateTemplates templates_;
};

}  // namespace gatefly
