// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "gatefly/link/bytes.hpp"

namespace gatefly::link_sim {

/// A UDP socket of this machine alone: 127.0.0.1 on both ends. It never waits.
class Datagrams {
 public:
  /// One that sends. @throws std::runtime_error one line.
  [[nodiscard]] static Datagrams to(int port);
  /// One that hears. @throws std::runtime_error one line: the port is taken.
  [[nodiscard]] static Datagrams at(int port);
  Datagrams(Datagrams&& other) noexcept;
  Datagrams& operator=(Datagrams&&) = delete;
  ~Datagrams();

  /// Nobody need be there to hear it.
  void send(link::Bytes bytes) const;
  /// To whom the last one that was received came from.
  void answer(link::Bytes bytes) const;
  /// The next one that has arrived, in `room`.
  [[nodiscard]] std::optional<link::Bytes> receive(std::span<std::uint8_t> room);

 private:
  Datagrams(int port, bool hears);
  int fd_ = -1, last_sender_ = 0;  ///< A port.
};

}  // namespace gatefly::link_sim
