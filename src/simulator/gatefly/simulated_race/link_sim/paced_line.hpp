// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "gatefly/link/bytes.hpp"
#include "gatefly/link/msp.hpp"
#include "gatefly/live/clock.hpp"
#include "gatefly/simulated_race/link_sim/tcp_door.hpp"

namespace gatefly::link_sim {

/// How long a controller has had to do with one stick frame. Two threads may use it.
class StickGaps {
 public:
  /// Bytes on their way to the controller.
  void take(link::Bytes bytes, live::Moment now);
  /// The longest time from one stick frame to the next that has ended, or still lasts, since this was last asked [s]; 0 before the first.
  [[nodiscard]] double longest(live::Moment now);

 private:
  std::mutex mutex_;
  msp::Stream stream_;
  std::optional<live::Moment> last_;
  live::Clock::duration longest_{};
};

/// A serial line between a program and a flight controller that has TCP only: bytes go both ways as fast as its speed lets them.
/// As on a serial line there is one client; a second one is hung up on.
class PacedLine {
 public:
  /// @param port  of the program's end, on 127.0.0.1. @param controller  the controller's port there.
  /// @throws std::runtime_error one line: the port is taken.
  PacedLine(int port, int controller, int baud);
  ~PacedLine();
  PacedLine(const PacedLine&) = delete;
  PacedLine& operator=(const PacedLine&) = delete;

  /// A client is there, and the controller has answered its call.
  [[nodiscard]] bool connected() const { return connected_; }
  /// From now on nothing is carried, and both ends hear nothing of it: the cable is out.
  void cut() { cut_ = true; }
  /// Gaps in the stream to the controller.
  [[nodiscard]] StickGaps& stick_gaps() { return stick_gaps_; }

 private:
  void work();
  void carry(live::Port& client, live::Port& controller);

  TcpDoor door_;
  int controller_port_, baud_;
  std::atomic<bool> over_ = false, connected_ = false, cut_ = false;
  StickGaps stick_gaps_;
  std::thread thread_;
};

}  // namespace gatefly::link_sim
