// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/search/bar_finder.hpp"
#include "gatefly/detection/search/evidence_map.hpp"
#include "gatefly/detection/search/search_trace.hpp"
#include "gatefly/drawing/canvas.hpp"

namespace gatefly::drawing {

/// A frame that was considered, as the sheet lists it.
struct ListedFrame {
  Quad bars_px{};
  FrameScore score;
  bool taken = false;
  std::string fate;  ///< Its outcome, in words.
};

/// Contents of a sheet on one picture.
struct SearchSheet {
  std::string title, in_words;
  std::span<const GateDetection> found;  ///< Detections answered.
  std::span<const GateDetection> fast;   ///< Detections of the fast search.
  const EvidenceMap& map;
  const BarFinder::Bars& bars;
  const SearchTrace& trace;
  std::vector<ListedFrame> listed;
};

/// Four panels (the answer; the evidence; the careful search's places and frames, numbered as
/// listed; the fast search's bars) and below them the list. @throws std::runtime_error when the
/// picture is empty.
[[nodiscard]] Canvas drawn(const SearchSheet& sheet, const Image& image);

}  // namespace gatefly::drawing
