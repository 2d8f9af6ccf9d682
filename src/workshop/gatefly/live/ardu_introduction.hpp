// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/guard/ardu_interview.hpp"
#include "gatefly/live/port.hpp"

namespace gatefly::live {

/// An ArduCopter's answers to what a program must know before it starts.
struct ArduIntroduction {
  guard::ArduFacts facts;
  bool other_client = false;
};

/// Asks for all of it. @param system  the drone's; what others say is not heard.
/// @throws std::runtime_error one line: nobody of that id is there.
[[nodiscard]] ArduIntroduction ardu_introduction_of(Port& port, int system);

}  // namespace gatefly::live
