// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gatefly/guard/interview.hpp"
#include "gatefly/live/port.hpp"

namespace gatefly::live {

/// A Betaflight's answers to what a program must know before it starts.
struct Introduction {
  guard::DroneFacts facts;
  std::string board;  ///< Four letters of MSP_BOARD_INFO; "": it does not say.
  bool other_client = false;
};

/// Asks for all of it. @throws std::runtime_error one line: nobody answers as a controller does.
[[nodiscard]] Introduction introduction_of(Port& port);

}  // namespace gatefly::live
