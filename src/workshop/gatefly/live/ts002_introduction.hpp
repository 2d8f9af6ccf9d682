// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "gatefly/link/mavlink_telemetry.hpp"
#include "gatefly/live/port.hpp"

namespace gatefly::live {

/// Answers of a simulator that speaks TS-002, before anything starts.
struct Ts002Introduction {
  bool armed = false;
  bool clock = false;  ///< It answers TIMESYNC.
  bool other_client = false;
  /// The name of a real drone's autopilot, if it says that it is one.
  std::optional<std::string_view> autopilot;
};

/// The autopilot that a heartbeat names, if it is one of a known make: a real drone's, and no simulator of TS-002.
[[nodiscard]] std::optional<std::string_view> autopilot_in(const mavlink::Heartbeat& beat);

/// Listens until it has told all of it. @param system  the drone's; what others say is not heard.
/// @throws std::runtime_error one line: nobody of that id is there, or it sends no HIGHRES_IMU.
[[nodiscard]] Ts002Introduction ts002_introduction_of(Port& port, int system);

}  // namespace gatefly::live
