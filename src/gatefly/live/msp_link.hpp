// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <sys/types.h>

#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/msp_poller.hpp"
#include "gatefly/live/port.hpp"
#include "gatefly/live/uri.hpp"

namespace gatefly::live {

/// A controller's answers to what a program must know before it starts.
struct Introduction {
  guard::DroneFacts facts;
  std::string board;  ///< Four letters of MSP_BOARD_INFO; "": it does not say.
  bool other_client = false;
};

/// Asks for all of it. @throws std::runtime_error one line: nobody answers as a controller does.
[[nodiscard]] Introduction introduction_of(Port& port);

/// The port that `--link` names; no recording. @throws std::runtime_error one line: nobody is there.
[[nodiscard]] Port opened(const LinkUri& uri);

/// A controller that has answered as the drone of the file does.
struct Introduced {
  Port port;
  msp::BoxIds boxes;
};
/// @param only_listens  one who never sends sticks may come in flight.
/// @throws std::runtime_error one line: nobody is there, another drone, a complaint, another client; armed or overridden.
[[nodiscard]] Introduced introduced(const LinkUri& uri, const DroneFile& drone, bool only_listens);

/// A stick frame that has gone out, and what the controller had said by then: all that a witness needs to know.
struct SentFrame {
  pid_t process = 0;
  Moment at;
  msp::Sticks sent, read;  ///< Read back: what the controller flies by.
  Moment read_at, status_at;
  bool armed = false, override_on = false;
  int acknowledged = 0;
};

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
  Moment start_;  ///< Start of the clock that the poller's times are measured by.
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
  /// From now on a SentFrame goes there with every frame, if there is room for it. @param line  a socket of packets.
  void report_to(int line) { witness_ = line; }

 private:
  void report(const msp::Sticks& sticks) const;

  msp::ChannelOrder order_;
  int witness_ = -1;
};

}  // namespace gatefly::live
