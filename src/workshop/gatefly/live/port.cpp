// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/port.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

namespace gatefly::live {
namespace {

struct Speed {
  int baud;
  speed_t code;
};
constexpr std::array kSpeeds{
    Speed{9600, B9600},     Speed{19200, B19200},   Speed{38400, B38400},
    Speed{57600, B57600},   Speed{115200, B115200}, Speed{230400, B230400},
    Speed{460800, B460800}, Speed{921600, B921600}, Speed{1000000, B1000000}};

[[noreturn]] void cannot_open(const std::string& name, const std::string& why) {
  throw std::runtime_error(name + ": cannot be opened: " + why);
}

/// Time left, rounded up, as poll() wants it: it must not return a little too early again and again.
int milliseconds_until(Moment deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::clamp<std::int64_t>(left, 0, 60'000));
}

/// The IPv4 address of a host name or number.
in_addr address_of(const std::string& host, const std::string& name) {
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), nullptr, &wanted, &found); error != 0)
    cannot_open(name, host + ": " + gai_strerror(error));
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof address);
  freeaddrinfo(found);
  return address.sin_addr;
}

sockaddr_in socket_address(in_addr host, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr = host;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

}  // namespace

Port::Port(int fd, std::string name) : fd_{fd}, name_{std::move(name)} {
  if (fd_ < 0) return;
  fcntl(fd_, F_SETFL, fcntl(fd_, F_GETFL) | O_NONBLOCK);
  int type = 0;
  socklen_t size = sizeof type;
  datagrams_ = getsockopt(fd_, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_DGRAM;
}
Port::Port(Port&& other) noexcept
    : fd_{std::exchange(other.fd_, -1)},
      name_{std::move(other.name_)},
      datagrams_{other.datagrams_},
      peer_{other.peer_} {}
Port& Port::operator=(Port&& other) noexcept {
  std::swap(fd_, other.fd_), std::swap(name_, other.name_);
  std::swap(datagrams_, other.datagrams_), std::swap(peer_, other.peer_);
  return *this;
}
Port::~Port() {
  if (fd_ >= 0) ::close(fd_);
}

Port Port::tcp(const std::string& host, int port, Moment deadline) {
  const std::string name = host + ":" + std::to_string(port);
  const sockaddr_in to = socket_address(address_of(host, name), port);
  Port made{socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), name};
  if (made.fd_ < 0) cannot_open(name, std::strerror(errno));
  if (connect(made.fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
    if (errno != EINPROGRESS && errno != EINTR) cannot_open(name, std::strerror(errno));
    if (!made.ready(POLLOUT, deadline)) cannot_open(name, "nobody answers");
    int error = 0;
    socklen_t size = sizeof error;
    getsockopt(made.fd_, SOL_SOCKET, SO_ERROR, &error, &size);
    if (error != 0) cannot_open(name, std::strerror(error));
  }
  const int yes = 1;  // a frame goes at once, not when there are more
  setsockopt(made.fd_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  return made;
}

Port Port::serial(const std::string& path, int baud) {
  const auto speed = std::find_if(kSpeeds.begin(), kSpeeds.end(),
                                  [&](const Speed& each) { return each.baud == baud; });
  if (speed == kSpeeds.end())
    cannot_open(path, "baud = " + std::to_string(baud) + ", must be one of " + speeds());
  Port made{open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC), path};
  if (made.fd_ < 0) cannot_open(path, std::strerror(errno));
  termios line{};
  if (tcgetattr(made.fd_, &line) != 0) cannot_open(path, "is no serial line");
  // Two programs on one line hang a Betaflight 4.4: who comes second gets EBUSY (but root).
  if (ioctl(made.fd_, TIOCEXCL) != 0) cannot_open(path, std::strerror(errno));
  cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  line.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | PARENB | CRTSCTS | HUPCL);
  cfsetispeed(&line, speed->code), cfsetospeed(&line, speed->code);
  if (tcsetattr(made.fd_, TCSANOW, &line) != 0) cannot_open(path, std::strerror(errno));
  tcflush(made.fd_, TCIOFLUSH);
  return made;
}

Port Port::udp(const std::string& bind_to, int port, const std::string& peer) {
  const std::string name = "udp " + bind_to + ":" + std::to_string(port);
  const sockaddr_in at = socket_address(address_of(bind_to, name), port);
  Port made{socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0), name};
  if (made.fd_ < 0) cannot_open(name, std::strerror(errno));
  made.peer_ = address_of(peer, name).s_addr;
  if (bind(made.fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
    cannot_open(name, std::strerror(errno));
  return made;
}

Port Port::udp_to(const std::string& host, int port, const std::string& bind_to) {
  const std::string name = "udp " + host + ":" + std::to_string(port);
  const sockaddr_in to = socket_address(address_of(host, name), port);
  const sockaddr_in at = socket_address(address_of(bind_to, name), 0);
  Port made{socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0), name};
  if (made.fd_ < 0 || bind(made.fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
    cannot_open(name, std::strerror(errno));
  if (connect(made.fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
    cannot_open(name, std::string{std::strerror(errno)} + " from " + bind_to +
                          ": ?bind=ADDRESS names this machine's there");
  return made;
}

Port Port::udp_from(const std::string& bind_to, int port, const std::string& peer,
                    Moment deadline) {
  Port made = udp(bind_to, port, peer);
  while (made.ready(POLLIN, deadline)) {
    std::array<std::uint8_t, 1> room{};
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t got =
        recvfrom(made.fd_, room.data(), room.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (got < 0 || from.sin_addr.s_addr != *made.peer_) continue;
    // From now on the kernel drops what others send.
    if (connect(made.fd_, reinterpret_cast<const sockaddr*>(&from), size) != 0)
      cannot_open(made.name_, std::strerror(errno));
    made.peer_.reset();
    return made;
  }
  cannot_open(made.name_, "nobody calls from " + peer);
}

std::string Port::speeds() {
  std::string all;
  for (const Speed& speed : kSpeeds) all += (all.empty() ? "" : ", ") + std::to_string(speed.baud);
  return all;
}

bool Port::ready(short events, Moment deadline) const {
  for (;;) {
    pollfd waiting{fd_, events, 0};
    const int found = poll(&waiting, 1, milliseconds_until(deadline));
    if (found > 0) return true;
    if (found == 0 && Clock::now() >= deadline) return false;
    if (found < 0 && errno != EINTR) return true;  // read() or write() says what is wrong
  }
}

std::optional<std::size_t> Port::receive(std::span<std::uint8_t> room) const {
  if (!peer_) {
    const ssize_t got = ::read(fd_, room.data(), room.size());
    if (got > 0) return static_cast<std::size_t>(got);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
    // An empty datagram, or that the last one found nobody: he may come back.
    if (datagrams_ && (got == 0 || errno == ECONNREFUSED)) return 0;
    return std::nullopt;
  }
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const ssize_t got =
      recvfrom(fd_, room.data(), room.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
  if (got < 0)
    return errno == EAGAIN || errno == EINTR ? std::optional<std::size_t>{0} : std::nullopt;
  return from.sin_addr.s_addr == *peer_ ? static_cast<std::size_t>(got) : 0;
}

std::optional<std::size_t> Port::read(std::span<std::uint8_t> room, Moment deadline) {
  for (;;) {
    const auto got = receive(room);
    if (got != std::size_t{0}) return got;
    if (!ready(POLLIN, deadline)) return 0;
  }
}

bool Port::write(link::Bytes bytes, Moment deadline) {
  while (!bytes.empty()) {
    const ssize_t put = ::write(fd_, bytes.data(), bytes.size());
    if (put > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(put));
    } else if (put < 0 && errno == ECONNREFUSED && datagrams_) {
      // The one before left a result; this one is sent the next time round.
    } else if (put < 0 && errno != EAGAIN && errno != EINTR) {
      return false;
    } else if (!ready(POLLOUT, deadline)) {
      return false;
    }
  }
  return true;
}

}  // namespace gatefly::live
