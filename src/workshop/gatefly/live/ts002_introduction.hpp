// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "gatefly/live/port.hpp"

namespace gatefly::live {

/// What a simulator that speaks TS-002 tells of itself before anything starts.
struct Ts002Introduction {
  bool armed = false;
  bool clock = false;  ///< It answers TIMESYNC.
  bool other_client = false;
  /// The name of a real drone's autopilot, if it says that it is one.
  std::optional<std::string_view> autopilot;
};

/// Listens until it has told all of it. @param system  the drone's; what others say is not heard.
/// @throws std::runtime_error one line: nobody of that id is there, or it sends no HIGHRES_IMU.
[[nodiscard]] Ts002Introduction ts002_introduction_of(Port& port, int system);

}  // namespace gatefly::live
