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
/// Ahead, ahead and to one side, ahead and to the other; never over a hole, which the 2018
/// flight code does (docs/paper/deviations.md#alg-2). Ends at the border at the latest.
inline Pixel snake(const ColorMask& is_gate, Pixel p, int du, int dv) {
  const int side_u = dv != 0 ? 1 : 0, side_v = du != 0 ? 1 : 0;
  // At most once a pixel: each step goes one on in (du, dv).
  for (;;) {
    if (is_gate(p.u + du, p.v + dv)) {
      p = {p.u + du, p.v + dv};
    } else if (is_gate(p.u + du - side_u, p.v + dv - side_v)) {
      p = {p.u + du - side_u, p.v + dv - side_v};
    } else if (is_gate(p.u + du + side_u, p.v + dv + side_v)) {
      p = {p.u + du + side_u, p.v + dv + side_v};
    } else {
      return p;
    }
  }
}

}  // namespace gatefly
