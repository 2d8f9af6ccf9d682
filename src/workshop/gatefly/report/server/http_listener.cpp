// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/server/http_listener.hpp"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <list>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "gatefly/report/server/http_connection.hpp"

namespace gatefly::server {
namespace {

constexpr std::size_t kMostConnections = 32;

[[noreturn]] void fail() {
  throw std::runtime_error(std::string{"127.0.0.1: this port cannot be had: "} +
                           std::strerror(errno));
}

/// One client, served by a thread of its own; oldest first in their list.
class Connection {
 public:
  Connection(int socket, const HttpListener::Answerer& answerer) : socket_{socket} {
    try {
      thread_ = std::thread{[this, &answerer] {
        serve(socket_, answerer, asking_);
        ended_ = true;
      }};
    } catch (const std::system_error&) {  // no thread to be had
      ::close(socket_);
      throw;
    }
  }
  ~Connection() {
    hang_up();
    thread_.join();
    ::close(socket_);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] bool asking() const { return asking_; }
  void hang_up() { ::shutdown(socket_, SHUT_RDWR); }

 private:
  int socket_;
  std::atomic<bool> asking_{true}, ended_{false};
  std::thread thread_;
};

}  // namespace

struct HttpListener::Parts {
  explicit Parts(Answerer a) : answerer{std::move(a)} {}
  ~Parts() {
    if (thread.joinable()) {
      const std::uint64_t one = 1;
      (void)!::write(stop, &one, sizeof one);
      thread.join();
    }
    for (const int file : {listening, stop})
      if (file >= 0) ::close(file);
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  void accept_until_stopped() {
    std::list<Connection> connections;
    for (;;) {
      pollfd either[2] = {{listening, POLLIN, 0}, {stop, POLLIN, 0}};
      (void)::poll(either, 2, -1);
      if (either[1].revents != 0) return;
      const int socket = ::accept4(listening, nullptr, nullptr, SOCK_CLOEXEC);
      connections.remove_if([](const Connection& one) { return one.ended(); });
      if (socket >= 0)
        take(connections, socket);
      else if (errno == EMFILE || errno == ENFILE || errno == ENOMEM || errno == ENOBUFS)
        std::this_thread::sleep_for(std::chrono::milliseconds{50});
    }
  }

  void take(std::list<Connection>& connections, int socket) const {
    if (connections.size() >= kMostConnections) {
      auto oldest = connections.begin();
      for (auto one = connections.begin(); one != connections.end(); ++one)
        if (one->asking()) {
          oldest = one;
          break;
        }
      connections.erase(oldest);
    }
    try {
      connections.emplace_back(socket, answerer);
    } catch (const std::system_error&) {  // it may come again
    }
  }

  Answerer answerer;
  int listening = -1, stop = -1;
  std::thread thread;
};

HttpListener::HttpListener(Answerer answerer)
    : parts_{std::make_unique<Parts>(std::move(answerer))} {}
HttpListener::~HttpListener() = default;

int HttpListener::start(int port) {
  Parts& p = *parts_;
  p.stop = ::eventfd(0, EFD_CLOEXEC);
  p.listening = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (p.stop < 0 || p.listening < 0) fail();
  const int yes = 1;  // not SO_REUSEPORT: two would share a port
  ::setsockopt(p.listening, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const where = reinterpret_cast<sockaddr*>(&address);
  if (::bind(p.listening, where, size) != 0 || ::listen(p.listening, 64) != 0 ||
      ::getsockname(p.listening, where, &size) != 0)
    fail();
  p.thread = std::thread{[&p] { p.accept_until_stopped(); }};
  return ntohs(address.sin_port);
}

}  // namespace gatefly::server
