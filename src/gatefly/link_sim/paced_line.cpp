// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link_sim/paced_line.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gatefly::link_sim {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

sockaddr_in at_home(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

void send_at_once(int fd) {
  const int yes = 1;
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

int called(int port) {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in to = at_home(port);
  if (fd >= 0 && connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) {
    send_at_once(fd);
    return fd;
  }
  if (fd >= 0) close(fd);
  return -1;
}

/// One direction: what it may carry grows with time, ten bits a byte, and what is not used is lost.
class Direction {
 public:
  Direction(int from, int to, int baud) : from_{from}, to_{to}, bytes_per_second_{baud / 10.0} {}

  /// False when an end is gone.
  bool carry(double elapsed) {
    constexpr double kHeld = 0.01;  // what a UART's buffer evens out [s]
    allowed_ =
        std::min(allowed_ + elapsed * bytes_per_second_, std::max(1.0, kHeld * bytes_per_second_));
    std::array<std::uint8_t, 4096> room{};
    const auto most = std::min(room.size(), static_cast<std::size_t>(allowed_));
    if (most == 0) return true;
    const ssize_t got = recv(from_, room.data(), most, MSG_DONTWAIT);
    if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) return false;
    if (got < 0) return true;
    allowed_ -= static_cast<double>(got);
    return send(to_, room.data(), static_cast<std::size_t>(got), MSG_NOSIGNAL) == got;
  }

 private:
  int from_, to_;
  double bytes_per_second_, allowed_ = 0.0;
};

}  // namespace

PacedLine::PacedLine(int port, int controller, int baud)
    : listener_{socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)},
      controller_port_{controller},
      baud_{baud} {
  const sockaddr_in at = at_home(port);
  const int yes = 1;
  if (listener_ >= 0) setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (listener_ < 0 || bind(listener_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0 ||
      listen(listener_, 1) != 0) {
    const std::string why = std::strerror(errno);
    if (listener_ >= 0) close(listener_);
    throw std::runtime_error("127.0.0.1:" + std::to_string(port) + ": cannot be opened: " + why);
  }
  thread_ = std::thread{[this] { work(); }};
}

PacedLine::~PacedLine() {
  over_ = true;
  thread_.join();
  close(listener_);
}

void PacedLine::work() {
  while (!over_) {
    pollfd waiting{listener_, POLLIN, 0};
    if (poll(&waiting, 1, 50) <= 0) continue;
    const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client < 0) continue;
    send_at_once(client);
    const int controller = called(controller_port_);
    if (controller >= 0) {
      connected_ = true;
      carry(client, controller);
      connected_ = false;
      close(controller);
    }
    close(client);
  }
}

void PacedLine::carry(int client, int controller) {
  Direction there{client, controller, baud_}, back{controller, client, baud_};
  for (auto last = steady_clock::now(); !over_; std::this_thread::sleep_for(500us)) {
    const auto now = steady_clock::now();
    const double elapsed = std::chrono::duration<double>(now - last).count();
    last = now;
    if (!there.carry(elapsed) || !back.carry(elapsed)) return;
    if (const int second = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC); second >= 0)
      close(second);
  }
}

}  // namespace gatefly::link_sim
