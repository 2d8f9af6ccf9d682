// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace gatefly {

struct AltitudeParams {
  double kp = 5.0;            ///< [(m/s²)/m] [Li18 code: 4.3]
  double kd = 3.6;            ///< [(m/s²)/(m/s)] [Li18 code: 1.1, which rings at ζ 0.26]
  double ki = 0.8;            ///< [(m/s²)/(m s)] carries battery sag and mass. [ours]
  double max_accel = 4.0;     ///< [m/s²]
  double max_integral = 2.5;  ///< [m/s²]
};

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
