// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "gatefly/detection/quad.hpp"
#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/geometry/rng.hpp"
#include "gatefly/sensing/color_range.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Every default says where it comes from: the paper, its flight code, or an experiment of ours.
struct SnakeGateParams {
  int max_samples = 4'000;          ///< Random pixels per saturation level. [Li18 code: 10,000 at one level]
  std::array<int, 5> chroma_levels{52, 38, 27, 18, 0};  ///< Tried in turn until a gate is sure. [ours]
  double sure_fitness = 0.85;       ///< Colour fitness at which no lower level is tried. [ours]
  double min_side_px = 20.0;        ///< σ_L. Paper: 25, flown: 30. [ours: gates are wanted from 6 m on]
  double min_color_fitness = 0.60;  ///< σ_cf on the refined outline, 1 px tolerance. [ours]
  double min_side_fitness = 0.35;   ///< Each of the four sides. [Li18 flight code: 0.30]
  double max_inside = 0.25;         ///< Coloured part of the central box. [Li18 flight code]
  double window = 0.40;             ///< Corner window's half width / half gate size. [Li18 flight code]
  double bar_ratio = 0.05;          ///< Bar width / outer side of the gate.
  double max_aspect = 1.8;          ///< Longest side / shortest side. [2018 flight code: 1.5]
};

struct GateDetection {
  Quad corners_px{};           ///< Outer corners, sub-pixel; clockwise from top-left.
  double color_fitness = 0.0;  ///< cf in 0..1, Eq. (1).
  bool whole = true;           ///< All four bars are in the picture; else corners outside are a guess.
};

/// Distinct gates of one picture, best first.
using GateDetections = FixedList<GateDetection, 6>;

/// Finds gates in an image that still carries lens distortion. Li18 §3.1, Algorithms 1 and 2.
///
/// Differs: docs/paper/deviations.md#alg-1 (best fitness wins, not the first; both horizontal searches
/// start at the end points; square *and* end-point quad are tried; saturation from high to low; four sides and an empty inside are
/// asked for; corners are intersections of lines fitted to the bars).
/// @param rng  source of the samples: same image, same generator state, same answer.
/// Cost: O(samples + hits x gate size), allocates nothing.
[[nodiscard]] GateDetections detect_gates(const Image& image, const ColorRange& color,
                                          const SnakeGateParams& params, Rng& rng);

/// Looks again where a gate was: refines `previous` on this image; empty when it is not there.
/// As flown ("re-try of last frame's corners").
[[nodiscard]] GateDetections detect_gates_near(const Image& image, const ColorRange& color,
                                               const SnakeGateParams& params, const Quad& previous);

}  // namespace gatefly
