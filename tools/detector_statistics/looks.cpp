// SPDX-License-Identifier: Apache-2.0
#include "looks.hpp"

#include <cmath>

namespace gatefly::measuring {

const char* name_of(Kind kind) {
  constexpr std::array<const char*, kKinds> kNames{"whole gates, the largest",
                                                   "whole gates beside it",
                                                   "whole gates aslant or small",
                                                   "gates with two or three corners in view",
                                                   "crooked frames on a gate",
                                                   "frames of two gates",
                                                   "decoys",
                                                   "places",
                                                   "lower corners of gates cut off above",
                                                   "side bars",
                                                   "false lower corners",
                                                   "false side bars",
                                                   "gates that the border cuts",
                                                   "false cut gates"};
  return kNames[static_cast<std::size_t>(kind)];
}

double side_of(const Quad& quad) { return std::sqrt(std::abs(area(quad))); }

}  // namespace gatefly::measuring
