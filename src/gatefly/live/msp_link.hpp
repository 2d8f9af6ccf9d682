// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/msp_poller.hpp"
#include "gatefly/live/port.hpp"

namespace gatefly::live {

/// A controller's answers to what a program must know before it starts.
struct Introduction {
  guard::DroneFacts facts;
  std::string board;  ///< Four letters of MSP_BOARD_INFO; "": it does not say.
  bool other_client = false;
};

/// Asks for all of it. @throws std::runtime_error one line: nobody answers as a controller does.
[[nodiscard]] Introduction introduction_of(Port& port);

/// A controller that is asked, and nothing else: a link of this type has no function that sends sticks.
class MspQueries {
 public:
  MspQueries(Port port, const DroneFile& drone, const msp::BoxIds& boxes);

  /// Asks what is due and takes what comes, until something has come or `until`. @return whether an IMU sample has.
  bool serve(const RunClock& clock, std::chrono::nanoseconds until);
  [[nodiscard]] const ControllerState& state() const { return poller_.state(); }
  [[nodiscard]] bool broken() const { return broken_; }
  [[nodiscard]] const std::string& name() const { return port_.name(); }

 private:
  friend class MspSticks;
  Port port_;
  MspPoller poller_;
  std::array<std::uint8_t, 512> room_{};
  bool broken_ = false;
};

/// The same, and it sends sticks.
class MspSticks : public MspQueries {
 public:
  MspSticks(Port port, const DroneFile& drone, const msp::BoxIds& boxes);
  /// A stick frame, whole or, where the line does not take it at once, not at all.
  bool send(const msp::Sticks& sticks);
  [[nodiscard]] int fd() const { return port_.fd(); }

 private:
  msp::ChannelOrder order_;
};

}  // namespace gatefly::live
