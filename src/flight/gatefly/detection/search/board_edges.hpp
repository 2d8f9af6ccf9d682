// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// The edges of the boards that are looked for.
enum class BoardEdge { kOuter, kInner };

/// Width of a frame's boards across them: of its level and of its upright ones [px].
struct BoardWidths {
  // Not explicit: seen from ahead both are alike.
  BoardWidths(double both) : level{both}, upright{both} {}  // NOLINT(google-explicit-constructor)
  BoardWidths(double of_level, double of_upright) : level{of_level}, upright{of_upright} {}

  double level, upright;
};

/// The outer or the inner edges of a frame of boards.
struct BoardEdges {
  Quad corners;  ///< Crossings of neighbouring edges [px].
  Quad middles;  ///< The same, half a board nearer to the boards' middle lines [px].
  /// Sides whose edge shows: TL-TR, TR-BR, BR-BL, BL-TL. The others are taken half a board beyond
  /// their middle line.
  std::array<bool, 4> seen = {};
  std::array<bool, 4> crossed = {};  ///< Corners by crossing; else the given ones.
  /// Corners in which there is a board: a panel of its colour beside one has edges, too, and they cross
  /// where there is none.
  std::array<bool, 4> filled = {};

  /// Whether both edges of a corner are seen, and cross there.
  [[nodiscard]] bool has(std::size_t corner) const {
    return crossed[corner] && seen[corner] && seen[(corner + 3) % 4];
  }
};

/// Finds the outer or the inner edges of a frame's boards, sub-pixel. [ours]
///
/// The middle line of a board half a metre wide says little of its corners: it is drawn beside the
/// middle of what is seen, and half a board is added in the picture's plane. The edges are where the
/// corners are. Across every side, station by station, the one step from the board's chroma to that of
/// what is beyond; through the steps a line, those far off counting less: worn paint and things that
/// stand before a gate move some of them.
/// @param bars_px  the boards' middle lines, to a third of a board's width [px].
/// @param board_px  width of the boards.
/// @param curves  how the lens bends the sides, in pixels.
/// Sides that are not in the picture, or show no edge, are half a board from their middle line.
/// Allocates nothing.
[[nodiscard]] BoardEdges board_edges(const Image& image, const Quad& bars_px,
                                     const BoardWidths& board_px, const SideCurves& curves = {},
                                     BoardEdge which = BoardEdge::kOuter);

}  // namespace gatefly
