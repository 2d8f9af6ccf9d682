// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Which colours are the gate's: a box in Y'CbCr, bounds included.
struct ColorRange {
  int y_min = 20, y_max = 228;   ///< [Li18 flight code, basement, March 2018]
  int u_min = 66, u_max = 194;   ///< Cb
  int v_min = 132, v_max = 230;  ///< Cr

  [[nodiscard]] bool contains(Yuv c) const {
    return c.v >= v_min && c.v <= v_max && c.u >= u_min && c.u <= u_max && c.y >= y_min &&
           c.y <= y_max;
  }
};

}  // namespace gatefly
