// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/link/mavlink_axes.hpp"
#include "gatefly/link/mavlink_commands.hpp"

// The outer loops of an autopilot that knows where it is, as a simulator does: from a set point of MAVLink to rates and thrust.

namespace gatefly::link_sim {

struct RatesAndThrust {
  Eigen::Vector3d rates_B = Eigen::Vector3d::Zero();  ///< About front, right, down [rad/s].
  double thrust = 0.0;                                ///< Part of the most there is, 0 … 1.
};

/// A drone as its autopilot knows it.
struct Known {
  mavlink::Place place;  ///< From where it stood at the beginning.
  gatefly::Attitude attitude;
  double hover = 0.5;  ///< Part of the thrust that hovers.
};

/// Turns towards the attitude, unless it is to be ignored, beside the rates that are not; without thrust, that of hover. What is no
/// number counts as nothing.
[[nodiscard]] RatesAndThrust wanted_of(const mavlink::SetAttitudeTarget& target, const Known& is);

/// Flies to the position, at the velocity, with the acceleration, each unless it is to be ignored; earth's axes or, with
/// MAV_FRAME_BODY_NED, those of the heading for all but the position.
[[nodiscard]] RatesAndThrust wanted_of(const mavlink::SetPositionTargetLocalNed& target,
                                       const Known& is);

}  // namespace gatefly::link_sim
