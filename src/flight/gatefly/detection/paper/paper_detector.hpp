// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/geometry/rng.hpp"
#include "gatefly/sensing/color_range.hpp"
#include "gatefly/sensing/image.hpp"

// The paper's two detectors, to compare with: what its ROC study ran offline, and what flew. None
// of the improvements of detection/search/ are in here. Readings of what the paper
// leaves open: docs/paper/deviations.md#paper-mode.

namespace gatefly {

/// The detector behind the paper's ROC curves.
struct PaperDetectorParams {
  /// Video-range Y 106-163, Cb 82-124, Cr 124-160 [authors' mask of the basement], as full-range
  /// bounds.
  ColorRange color{
      .y_min = 105, .y_max = 171, .u_min = 76, .u_max = 124, .v_min = 124, .v_max = 164};
  int samples = 1'000;  ///< Random pixels. [authors' analysis]
  /// σ_L, to be exceeded by what the snakes find and by every refined side. [Li18]
  double min_side_px = 25.0;
  double min_color_fitness = 0.7;  ///< σ_cf, to be exceeded. [authors' analysis]
  /// Half width of a corner window / half the square's side. [authors' analysis]
  double first_window = 0.5;
  double second_window = 0.4;  ///< The same in the second refinement. [authors' analysis]
  /// Shared part of both areas from which on two candidates are one; > 1: equal squares only.
  double same_gate = 0.7;
};

/// Everything that was accepted in one picture, in the order it was found.
using PaperDetections = FixedList<GateDetection, 1'000>;

/// Li18 Algorithms 1 and 2 as its ROC study ran them: no inside test, no four sides, every
/// candidate counts.
///
/// Corners are where the bars cross (modes of histograms), upright [px]. A full list ends the
/// search.
/// @param rng  source of the samples: same picture, same generator state, same answer.
/// Cost: O(samples x size of the largest gate), allocates nothing.
[[nodiscard]] PaperDetections detect_as_paper(const Image& image, const PaperDetectorParams& params,
                                              Rng& rng);

/// The detector that flew the 15 gates. [Li18 flight code, basement, March 2018]
struct FlownDetectorParams {
  ColorRange color{
      .y_min = 20, .y_max = 228, .u_min = 66, .u_max = 194, .v_min = 132, .v_max = 230};
  int samples = 10'000;
  double min_side_px = 30.0;       ///< σ_L.
  double min_side_fitness = 0.30;  ///< Coloured part at which a side counts; all four must.
  double max_inside = 0.25;        ///< Coloured part of the central box, half the gate's size.
  double window = 0.40;            ///< Half width of a corner window / half the gate's side.
  double min_fitness = 0.30;       ///< To be exceeded by the best gate.
};

/// The best gate by colour fitness, as flown: samples, squares checked on four sides and inside,
/// the last ten of those that improved on the one before refined and checked again.
///
/// @param previous  corners of the last picture's gate: tried again when this picture gives none.
[[nodiscard]] std::optional<GateDetection> detect_as_flown(
    const Image& image, const FlownDetectorParams& params, Rng& rng,
    const std::optional<Quad>& previous = std::nullopt);

}  // namespace gatefly
