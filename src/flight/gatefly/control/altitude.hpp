// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "gatefly/control/control_params.hpp"

namespace gatefly {

/// Specific thrust along −z_B whose vertical part is `vertical` [m/s²].
///
/// @param upright  cosine of the tilt; more than 53° is not made up for.
[[nodiscard]] inline double thrust_for(double vertical, double upright) {
  constexpr double kLeastUpright = 0.6;
  return vertical / std::max(kLeastUpright, upright);
}

/// Holds a height: PID on z (down), answering the vertical acceleration to ask for, upwards [m/s²].
class Altitude {
 public:
  double step(double z_target, double vz_target, double z, double vz, double dt,
              const AltitudeParams& params) {
    const double low = z - z_target;  // z is down: positive when too low
    integral_ =
        std::clamp(integral_ + params.ki * low * dt, -params.max_integral, params.max_integral);
    return std::clamp(params.kp * low + params.kd * (vz - vz_target) + integral_, -params.max_accel,
                      params.max_accel);
  }
  void reset() { integral_ = 0.0; }

 private:
  double integral_ = 0.0;
};

}  // namespace gatefly
