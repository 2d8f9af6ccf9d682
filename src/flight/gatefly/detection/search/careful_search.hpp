// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/picture_color.hpp"
#include "gatefly/detection/search/evidence_map.hpp"
#include "gatefly/detection/search/gate_templates.hpp"
#include "gatefly/detection/search/search_trace.hpp"

namespace gatefly {

/// Finds washed-out, blurred and turned gates: evidence everywhere, frames of every size and turn
/// tried everywhere, the best ones fitted. [ours; Li18 has no counterpart.]
class CarefulSearch {
 public:
  explicit CarefulSearch(const GateDetectorParams& params = {});

  /// Distinct gates, best first. Allocates nothing.
  /// @param within  searched alone; null: all of the picture.
  /// @param trace  filled with what was looked at, if given; empty before.
  [[nodiscard]] GateDetections detect(const Image& image, const PictureColor& color,
                                      const SearchWindow* within = nullptr,
                                      SearchTrace* trace = nullptr);

 private:
  GateDetectorParams params_;
  EvidenceMap map_;
  GateTemplates templates_;
  GateCandidates candidates_;  // here, for 4 KB are too much for the stack
  LensBend bend_;
  std::vector<LensBend> guesses_;  // what a lens that nobody named might be; else none
};

}  // namespace gatefly
