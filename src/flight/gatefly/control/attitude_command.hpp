// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gatefly {

/// Set point of the attitude loop, from guidance.
struct AttitudeCommand {
  double roll = 0.0, pitch = 0.0, yaw = 0.0;  ///< [rad]
  /// Feed-forward: how fast `yaw` itself moves [rad/s].
  double yaw_rate = 0.0;
  /// Specific thrust along −z_B, positive lifts [m/s²].
  double thrust = 0.0;
};

}  // namespace gatefly
