// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/link/msp_axes.hpp"
#include "gatefly/sensing/imu.hpp"

namespace gatefly::live {

/// A controller, as it tells of itself, whatever it speaks. Times are of arrival; never is before the first.
struct ControllerState {
  static constexpr std::chrono::nanoseconds kNever = -std::chrono::hours{24};
  Imu imu;
  gatefly::Attitude attitude;
  bool armed = false;
  /// Our commands are in effect: MSP OVERRIDE, the mode GUIDED_NOGPS, or armed, of a TS-002 simulator.
  bool override_on = false;
  bool lifted = false;     ///< Somebody flies it, as far as it tells.
  msp::Sticks sticks;      ///< The sticks it flies by, from the radio or from us.
  double battery_v = 0.0;  ///< 0: not known.
  double height = 0.0;     ///< Its own idea [m].
  std::chrono::nanoseconds imu_at = kNever, attitude_at = kNever, status_at = kNever;
  std::chrono::nanoseconds sticks_at = kNever;
  std::chrono::nanoseconds imu_changed_at = kNever;  ///< A sample that repeats itself is stuck.
  /// When the sample was taken, but for a constant delay: they come more regularly than they arrive.
  std::chrono::nanoseconds imu_taken = kNever;
  int acknowledged = 0;       ///< Set points.
  bool other_client = false;  ///< It answers what was not asked, or somebody else says so.
  std::uint64_t samples = 0, asked = 0, lost = 0, refused = 0;
};

}  // namespace gatefly::live
