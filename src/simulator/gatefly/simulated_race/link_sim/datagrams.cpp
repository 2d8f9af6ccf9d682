// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/datagrams.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gatefly::link_sim {

namespace {

sockaddr_in here(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

}  // namespace

Datagrams::Datagrams(int port, bool hears)
    : fd_{socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)} {
  const sockaddr_in address = here(port);
  const auto* const place = reinterpret_cast<const sockaddr*>(&address);
  const int failed = fd_ < 0 || (hears ? bind(fd_, place, sizeof address)
                                       : connect(fd_, place, sizeof address)) != 0;
  if (failed) {
    const std::string why = std::strerror(errno);
    if (fd_ >= 0) close(fd_);
    throw std::runtime_error("udp 127.0.0.1:" + std::to_string(port) +
                             ": cannot be opened: " + why);
  }
}
Datagrams Datagrams::to(int port) { return {port, false}; }
Datagrams Datagrams::at(int port) { return {port, true}; }
Datagrams::Datagrams(Datagrams&& other) noexcept
    : fd_{std::exchange(other.fd_, -1)}, last_sender_{other.last_sender_} {}
Datagrams::~Datagrams() {
  if (fd_ >= 0) close(fd_);
}

void Datagrams::send(link::Bytes bytes) const {
  (void)!::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

void Datagrams::answer(link::Bytes bytes) const {
  const sockaddr_in to = here(last_sender_);
  (void)sendto(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL,
               reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

std::optional<link::Bytes> Datagrams::receive(std::span<std::uint8_t> room) {
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const ssize_t got =
      recvfrom(fd_, room.data(), room.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
  if (got < 0) return std::nullopt;
  last_sender_ = ntohs(from.sin_port);
  return link::Bytes{room.first(static_cast<std::size_t>(got))};
}

}  // namespace gatefly::link_sim
