// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/color_model.hpp"
#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/search/evidence_map.hpp"
#include "gatefly/detection/search/gate_templates.hpp"

namespace gatefly {

/// Finds washed-out, blurred and turned gates: evidence everywhere, frames of every size and turn
/// tried everywhere, the best ones fitted. [ours; Li18 has no counterpart.]
class CarefulSearch {
 public:
  explicit CarefulSearch(const GateDetectorParams& params = {})
      : params_{params}, templates_{params.max_roll_deg} {}

  /// Distinct gates, best first. Allocates nothing.
  [[nodiscard]] GateDetections detect(const Image& image, const ColorModel& color);

 private:
  GateDetectorParams params_;
  EvidenceMap map_;
  GateTemplates templates_;
};

}  // namespace gatefly
