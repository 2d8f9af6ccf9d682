// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/live/port.hpp"

namespace gatefly::link_sim {

/// A TCP port of 127.0.0.1 at which others call.
class TcpDoor {
 public:
  /// @throws std::runtime_error one line: the port is taken.
  explicit TcpDoor(int port);
  ~TcpDoor();
  TcpDoor(const TcpDoor&) = delete;
  TcpDoor& operator=(const TcpDoor&) = delete;

  /// The next one that has called, if any. It never waits.
  [[nodiscard]] std::optional<live::Port> caller() const;
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_ = -1;
};

}  // namespace gatefly::link_sim
