// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/detection/search/bar_finder.hpp"
#include "gatefly/detection/search/evidence_map.hpp"
#include "gatefly/detection/search/search_trace.hpp"
#include "gatefly/race/pilot_config.hpp"

namespace gatefly::tasks {

/// A frame that the careful search considered, and what became of it.
struct ConsideredFrame {
  Quad bars_px{};  ///< Middle lines of its bars.
  FrameScore score;
  bool taken = false;    ///< It counts as a gate.
  bool closely = false;  ///< Looked at pixel by pixel; else on cells only.
  std::string fate;      ///< "taken", or why not: "score 1.90 < min_score 2.50".
};

/// Both searches' view of one picture: why a gate was found or missed.
struct SearchReport {
  std::vector<GateDetection> answered;  ///< Answer of `detect`.
  EvidenceMap map;                      ///< Evidence of the careful search.
  BarFinder::Bars bars;                 ///< Bars of the fast search.
  GateDetections fast;                  ///< Finds of the fast search alone.
  SearchTrace trace;                    ///< Trace of the careful search.
  std::vector<ConsideredFrame> considered;
  std::string in_words;  ///< Which search answered, and why.
};

/// Both searches over one picture, whether or not `detect` needs both.
/// @param answered  what gates_in_picture() gave.
[[nodiscard]] SearchReport explained(const Image& image, const PilotConfig& config,
                                     const std::vector<GateDetection>& answered);

/// {"in_words", "answered", "fast", "considered": [{"fate", "corners_px", "score": {...}}]}.
[[nodiscard]] nlohmann::ordered_json as_json(const SearchReport& report);

}  // namespace gatefly::tasks
