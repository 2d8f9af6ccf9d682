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

/// The corners of the bars' centre lines, sub-pixel: the middles of the coloured runs across each half
/// side, a line through them, neighbouring lines intersected. A corner whose lines fail keeps its place.
[[nodiscard]] Quad corners_by_lines(const ColorMask& is_gate, const Quad& rough);

/// `quad` made larger by `factor` about its centre.
[[nodiscard]] Quad scaled(const Quad& quad, double factor);

}  // namespace gatefly
