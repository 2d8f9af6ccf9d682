// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Which colours are the gate's: a box in Y'CbCr, bounds included, and how far from grey at least.
///
/// The box is a generic orange, wide enough for dim and for washed-out days; what makes one day's
/// gate stand out from wood and brick is its saturation, which the detector tries from high to low.
struct ColorRange {
  int y_min = 30, y_max = 250;   ///< [Li18 flight code: 20-228]
  int u_min = 30, u_max = 134;   ///< Cb [ours; Li18 code: 66-194, offline 82-124]
  int v_min = 132, v_max = 240;  ///< Cr [Li18 flight code, March 2018: 132-230]
  int min_chroma = 0;            ///< Distance of (Cb, Cr) from grey.

  [[nodiscard]] bool contains(Yuv c) const {
    if (c.v < v_min || c.v > v_max || c.u < u_min || c.u > u_max || c.y < y_min || c.y > y_max)
      return false;
    const int du = c.u - 128, dv = c.v - 128;
    return du * du + dv * dv >= min_chroma * min_chroma;
  }
};

}  // namespace gatefly
