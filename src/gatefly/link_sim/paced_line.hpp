// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <thread>

namespace gatefly::live {
class Port;
}

namespace gatefly::link_sim {

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

 private:
  void work();
  void carry(live::Port& client, live::Port& controller);

  int listener_ = -1, controller_port_, baud_;
  std::atomic<bool> over_ = false, connected_ = false;
  std::thread thread_;
};

}  // namespace gatefly::link_sim
