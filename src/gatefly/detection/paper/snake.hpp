// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "gatefly/detection/paper/color_mask.hpp"

namespace gatefly {

struct Pixel {
  int u, v;
};

inline double distance(Pixel a, Pixel b) {
  const double du = a.u - b.u, dv = a.v - b.v;
  return std::sqrt(du * du + dv * dv);
}

/// Follows a bar from `p` in direction (du, dv), one of them ±1: Li18 Algorithm 2, any of its
/// branches.
///
/// Ahead, ahead and to one side, ahead and to the other; over a hole of one pixel as well [2018
/// flight code] unless `over_holes` is false. Ends at the border at the latest.
inline Pixel snake(const ColorMask& is_gate, Pixel p, int du, int dv, bool over_holes = true) {
  const int side_u = dv != 0 ? 1 : 0, side_v = du != 0 ? 1 : 0;
  for (;;) {
    if (is_gate(p.u + du, p.v + dv)) {
      p = {p.u + du, p.v + dv};
    } else if (is_gate(p.u + du - side_u, p.v + dv - side_v)) {
      p = {p.u + du - side_u, p.v + dv - side_v};
    } else if (is_gate(p.u + du + side_u, p.v + dv + side_v)) {
      p = {p.u + du + side_u, p.v + dv + side_v};
    } else if (over_holes && is_gate(p.u + 2 * du, p.v + 2 * dv)) {
      p = {p.u + 2 * du, p.v + 2 * dv};
    } else {
      return p;
    }
  }
}

/// The farther end of the bar that leaves `start` to the left or to the right.
inline Pixel search_horizontal(const ColorMask& is_gate, Pixel start) {
  const Pixel left = snake(is_gate, start, -1, 0);
  const Pixel right = snake(is_gate, start, +1, 0);
  return distance(start, left) > distance(start, right) ? left : right;
}

}  // namespace gatefly
