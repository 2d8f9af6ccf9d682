// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/evidence_map.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {

/// A place in the picture where a gate may be, good to a few pixels.
struct GateCandidate {
  Quad corners_px{};  ///< Of the bars' centre lines.
  int score = 0;      ///< 0..255; only for comparison.
};

using GateCandidates = FixedList<GateCandidate, 96>;

/// Every square frame of a set of sizes, turns and foreshortenings, tried at every place of the
/// evidence.
///
/// On a pyramid of maxima, so that thin bars survive; a side is eight samples, a frame four sides
/// that are shared between frames, and an empty middle. Everything is bytes in long rows: sixteen
/// places an instruction. The cost depends on the picture's size only, not on what is in it.
class GateTemplates {
 public:
  GateTemplates();  ///< Allocates once; search() never does.

  /// Adds the best places to `found`, best first.
  /// @param max_roll_deg  largest turn that is tried; steps of 10°.
  void search(const EvidenceMap& map, double max_roll_deg, GateCandidates& found);

 private:
  struct Level;
  void start(const EvidenceMap& map);
  void halve();
  void search_level(const Level& level, GateCandidates& found);
  void collect(const Level& level, double size, GateCandidates& found);
  void keep(const Level& level, double size, int x, int y, int score, GateCandidates& found);

  std::vector<std::uint8_t> peak_, mean_;      // the pyramid's present level
  std::vector<std::uint8_t> upright_, level_;  // sums along the sides of frames
  std::vector<std::uint8_t> best_, which_;     // best frame of each place
  int width_ = 0, height_ = 0;                 // of the level, with its margin [cells]
  std::size_t worst_ = 0;                      // of a full list
};

}  // namespace gatefly
