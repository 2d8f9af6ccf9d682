// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "gatefly/link/bytes.hpp"
#include "gatefly/live/clock.hpp"

namespace gatefly::live {

/// A TCP connection, serial line or UDP socket. No call waits beyond its deadline, and a signal neither fails nor restarts a wait.
class Port {
 public:
  /// @param fd  becomes its own, and does not block from now on.
  Port(int fd, std::string name);
  Port(Port&& other) noexcept;
  Port& operator=(Port&& other) noexcept;
  ~Port();

  /// A TCP client. @throws std::runtime_error one line: nobody is there.
  [[nodiscard]] static Port tcp(const std::string& host, int port, Moment deadline);
  /// A serial line, 8N1, raw, for us alone. @throws std::runtime_error one line: not there, taken, no such speed.
  [[nodiscard]] static Port serial(const std::string& path, int baud);
  /// Datagrams at `port` of the address `bind`, of one that `peer` names; others are dropped.
  /// @throws std::runtime_error one line: no such address, the port is taken.
  [[nodiscard]] static Port udp(const std::string& bind, int port, const std::string& peer);
  /// Datagrams to and from `port` of `host`, and nobody else's; ours go out from the address `bind`.
  /// @throws std::runtime_error one line: no such address.
  [[nodiscard]] static Port udp_to(const std::string& host, int port, const std::string& bind);
  /// Datagrams to and from the first sender at `peer` that calls at `port` of the address `bind`, and nobody else's.
  /// @throws std::runtime_error one line: no such address, the port is taken, nobody calls until `deadline`.
  [[nodiscard]] static Port udp_from(const std::string& bind, int port, const std::string& peer,
                                     Moment deadline);
  /// The speeds that serial() knows: "9600, 19200, …".
  [[nodiscard]] static std::string speeds();

  /// Reads what has arrived, waiting until `deadline`. @return the number of bytes, 0 when none came; nullopt: closed or broken.
  [[nodiscard]] std::optional<std::size_t> read(std::span<std::uint8_t> room, Moment deadline);
  /// False: it did not take all of it until `deadline`, or is closed.
  [[nodiscard]] bool write(link::Bytes bytes, Moment deadline);

  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  [[nodiscard]] bool ready(short events, Moment deadline) const;
  [[nodiscard]] std::optional<std::size_t> receive(std::span<std::uint8_t> room) const;

  int fd_ = -1;
  std::string name_;
  bool datagrams_ = false;
  std::optional<std::uint32_t> peer_;  ///< IPv4 address as on the wire; of UDP.
};

}  // namespace gatefly::live
