// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "gatefly/detection/quad.hpp"

namespace gatefly::test {

/// The largest distance between corners, in the best cyclic order: which corner of a gate on its
/// edge is "top-left" is a matter of taste.
inline double worst_corner(const Quad& a, const Quad& b) {
  double best = 1e9;
  for (std::size_t turn = 0; turn < 4; ++turn) {
    double worst = 0;
    for (std::size_t i = 0; i < 4; ++i) worst = std::max(worst, (a[(i + turn) % 4] - b[i]).norm());
    best = std::min(best, worst);
  }
  return best;
}

}  // namespace gatefly::test
