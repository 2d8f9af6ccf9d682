// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/miss_cause.hpp"

#include <algorithm>

#include "gatefly/detection/search/careful_search.hpp"
#include "gatefly/files/scoring.hpp"

namespace gatefly::experiments {

std::string cause_of_miss(const Image& image, const Quad& corners_px, const ColorModel& color,
                          const GateDetectorParams& params) {
  constexpr double kSame = 0.5;  // of the larger one's area
  const Quad bars = scaled(files::polygon(corners_px), 1.0 / params.corner_scale);
  const auto is_there = [&](const Quad& quad) {
    return overlaps(files::polygon(quad), bars, kSame);
  };
  CarefulSearch search{params};
  SearchTrace trace;
  (void)search.detect(image, color, nullptr, &trace);
  for (const SearchTrace::Finished& frame : trace.finished) {
    if (!is_there(frame.frame_px)) continue;
    if (frame.taken) return "corners off";
    return frame.score.total < params.min_score ? "score" : "opening not empty";
  }
  const auto any = [&](auto quad) {
    return std::any_of(trace.places.begin(), trace.places.end(),
                       [&](const auto& place) { return is_there(place.*quad); });
  };
  if (any(&SearchTrace::Place::frame_px)) return "rough score";
  return any(&SearchTrace::Place::template_px) ? "pulled elsewhere" : "no place tried";
}

}  // namespace gatefly::experiments
