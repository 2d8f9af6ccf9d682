// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "gatefly/detection/color_mask.hpp"
#include "gatefly/detection/quad.hpp"

namespace gatefly {

/// How much of a quad's outline has the gate's colour.
struct OutlineFitness {
  double all = 0.0;              ///< cf = N_c / N over all four sides, Li18 Eq. (1).
  std::array<double, 4> side{};  ///< The same for top, right, bottom, left.
};

/// Colour fitness of an outline drawn 1 px wide, with a tolerance of 1 px.
[[nodiscard]] OutlineFitness outline_fitness(const ColorMask& is_gate, const Quad& quad);

/// Part of the central box (half the gate's size) that is coloured: a gate is empty inside.
[[nodiscard]] double inside_fraction(const ColorMask& is_gate, const Quad& quad);

/// Each corner moved to the mode of the row and column histograms of coloured pixels in its window.
/// Li18 §3.1 says centroid; the flight code takes the mode, which a stray patch does not pull.
[[nodiscard]] Quad corners_by_histogram(const ColorMask& is_gate, const Quad& rough, double window);

/// The outer corners of the bars around `center_line`: lines fitted to the outer edges of the bars,
/// intersected. A side whose edge cannot be followed keeps its place.
[[nodiscard]] Quad outer_corners(const ColorMask& is_gate, const Quad& center_line);

}  // namespace gatefly
