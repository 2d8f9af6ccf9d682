// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/evidence_map.hpp"
#include "gatefly/detection/search/frame_lattice.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {

/// A place in the picture where a gate may be, good to a few pixels.
struct GateCandidate {
  Quad corners_px{};  ///< Corners of the bars' centre lines.
  int score = 0;      ///< 0..255; only for comparison.
};

/// Places that are looked at closely: of five levels at most, twelve of each. [of 8, 12, 16, 24
/// on labelled and rendered pictures: 8 lose a small gate in a hundred, more than 12 gain hardly any]
using GateCandidates = FixedList<GateCandidate, 60>;

/// Every square frame of a set of sizes, turns and foreshortenings, tried at every place of the
/// evidence that may be a left bar and has another one to the right.
///
/// On a pyramid of maxima, so that thin bars survive; a side is eight samples, a frame four sides
/// and an empty middle. Everything is bytes in long rows, a block of neighbouring places at once.
/// Blocks in which no two upright sides show are passed over, and those that could not be good
/// enough with the best of lower sides.
class GateTemplates {
 public:
  /// Allocates once; search() never does.
  /// @param max_roll_deg  largest turn that is tried; steps of 10°.
  explicit GateTemplates(double max_roll_deg);

  /// Adds the best places of what the map has filled to `found`, best first.
  /// @param least  score of a place that is worth a look, 1..255.
  /// @param within  says which frames are tried; null: all.
  void search(const EvidenceMap& map, int least, GateCandidates& found,
              const SearchWindow* within = nullptr);

 private:
  // Candidates of one level: places on something large are many small ones, and must not take the
  // room of all.
  using LevelCandidates = FixedList<GateCandidate, 12>;

  void start(const EvidenceMap& map);
  void halve();
  void search_level(const FrameLattice& lattice, int pool, GateCandidates& found);
  [[nodiscard]] int least_to_keep(const LevelCandidates& found) const;
  void collect(const FrameLattice& lattice, std::size_t first, int pool, LevelCandidates& found);
  [[nodiscard]] int lost_beyond(const FrameLattice::Frame& frame, int x, int y) const;
  void keep(const FrameLattice::Frame& frame, int pool, int x, int y, int score,
            LevelCandidates& found);

  FrameLattice small_, medium_, large_;
  std::vector<std::uint8_t> peak_, mean_;   // the pyramid's present level
  std::vector<std::uint8_t> upright_;       // sums along the upright sides of frames
  std::vector<std::int32_t> blocks_;        // where one of them shows
  std::vector<std::uint8_t> best_, which_;  // best frame of each place
  int width_ = 0, height_ = 0;              // of the level, with its margin [cells]
  Eigen::Vector2d origin_px_{0, 0};         // corner of its first cell
  SearchWindow wanted_;                     // the frames that are tried
  int least_ = 0;
  std::size_t worst_ = 0;  // of a full list
};

}  // namespace gatefly
