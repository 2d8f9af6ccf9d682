// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "gatefly/control/control_params.hpp"

namespace gatefly {

/// Roll that brings the drone back onto its line. Li18 §4, Eq. (22): φ_c = −k_p ŷ − k_d ŷ̇.
/// @param y  to the right of the line [m]; @param v_y its rate [m/s].
[[nodiscard]] inline double lateral_roll(double y, double v_y, const LateralParams& params) {
  return std::clamp(-params.kp * y - params.kd * v_y, -params.max_roll, params.max_roll);
}

}  // namespace gatefly
