// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/guard/px4_interview.hpp"
#include "gatefly/live/port.hpp"

namespace gatefly::live {

/// A PX4's answers to what a program must know before it starts.
struct Px4Introduction {
  guard::Px4Facts facts;
  bool other_client = false;
};

/// Asks for all of it. @param system  the drone's; what others say is not heard.
/// @throws std::runtime_error one line: nobody of that id is there.
[[nodiscard]] Px4Introduction px4_introduction_of(Port& port, int system);

/// Whether the first heartbeat of the drone is a PX4's. Without one in five seconds it is not.
[[nodiscard]] bool is_px4(Port& port, int system);

}  // namespace gatefly::live
