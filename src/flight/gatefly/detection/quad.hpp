// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

namespace gatefly {

/// Four corners in the upright picture, clockwise from top-left: TL, TR, BR, BL [px].
using Quad = std::array<Eigen::Vector2d, 4>;

/// Area inside, positive when the corners run clockwise as seen (u right, v down) [px²].
[[nodiscard]] double area(const Quad& quad);

/// Area that two convex quads share [px²].
[[nodiscard]] double shared_area(const Quad& a, const Quad& b);

/// Whether two convex quads share at least `part` of the larger one's area.
[[nodiscard]] bool overlaps(const Quad& a, const Quad& b, double part);

/// Whether a quad is well inside another one: a gate seen through the opening of a nearer one.
[[nodiscard]] bool stands_within(const Quad& small, const Quad& large);

/// Whether two quads are of one gate: they share more than half of the smaller one, and neither
/// stands within the other.
[[nodiscard]] bool same_place(const Quad& a, const Quad& b);

/// The same corners, turned in the list so that the first is the one nearest to top-left.
[[nodiscard]] Quad clockwise_from_top_left(const Quad& quad);

/// The z of a x b.
[[nodiscard]] inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

[[nodiscard]] Eigen::Vector2d center(const Quad& quad);

/// How far the corner that moved most did, from a to b.
[[nodiscard]] double largest_move(const Quad& a, const Quad& b);

/// `quad` made larger by `factor` about its centre.
[[nodiscard]] Quad scaled(const Quad& quad, double factor);

/// Pixels to cells of `cell` by `cell` pixels, and back: the middle of either is a whole number.
[[nodiscard]] inline Eigen::Vector2d to_cells(const Eigen::Vector2d& p_px, double cell) {
  return ((p_px.array() + 0.5) / cell - 0.5).matrix();
}
[[nodiscard]] Quad to_cells(Quad quad_px, double cell);
[[nodiscard]] Quad to_pixels(Quad quad_cells, double cell);

}  // namespace gatefly
