// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "gatefly/control/control_params.hpp"

namespace gatefly {

/// The specific thrust that rotors give by now, by the data sheet, after what they were told.
///
/// Each rotor's speed follows with a lag. Thrust goes with its square: where commands shake, a lag on
/// the thrust would have it 2 % too high.
class RotorThrust {
 public:
  explicit RotorThrust(const VehicleParams& vehicle) : vehicle_{vehicle} {}

  /// @param commanded  speeds [rad/s]; @param time  now [s]. @return [m/s²]
  double update(const std::array<double, 4>& commanded, double time) {
    const double dt = std::max(0.0, time - time_);
    const double part = std::min(1.0, dt / vehicle_.rotor_time_constant);
    time_ = time;
    double squares = 0.0;
    for (std::size_t i = 0; i < speeds_.size(); ++i) {
      speeds_[i] += part * (commanded[i] - speeds_[i]);
      squares += speeds_[i] * speeds_[i];
    }
    return vehicle_.thrust_coefficient * squares / vehicle_.mass;
  }

 private:
  VehicleParams vehicle_;
  std::array<double, 4> speeds_{};  ///< [rad/s]
  double time_ = 0.0;
};

}  // namespace gatefly
