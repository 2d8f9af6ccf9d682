// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/paced_line.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "gatefly/live/port.hpp"

namespace gatefly::link_sim {
namespace {

using namespace std::chrono_literals;
using live::Clock;
using live::Port;

/// A TCP server that says back what it hears, of one client after the other.
class Echo {
 public:
  Echo() : listener_{socket(AF_INET, SOCK_STREAM, 0)} {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    bind(listener_, reinterpret_cast<const sockaddr*>(&at), size);
    listen(listener_, 1);
    getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size);
    port_ = ntohs(at.sin_port);
    thread_ = std::thread{[this] { work(); }};
  }
  ~Echo() {
    shutdown(listener_, SHUT_RDWR);
    thread_.join();
    close(listener_);
  }
  [[nodiscard]] int port() const { return port_; }

 private:
  void work() const {
    for (int client = accept(listener_, nullptr, nullptr); client >= 0;
         client = accept(listener_, nullptr, nullptr)) {
      std::array<char, 4096> room{};
      for (ssize_t got = recv(client, room.data(), room.size(), 0); got > 0;
           got = recv(client, room.data(), room.size(), 0))
        (void)!send(client, room.data(), static_cast<std::size_t>(got), MSG_NOSIGNAL);
      close(client);
    }
  }
  int listener_, port_ = 0;
  std::thread thread_;
};

/// A port that nobody has now.
int free_port() {
  const Echo taken;
  return taken.port();
}

std::vector<std::uint8_t> read_all(Port& port, std::size_t size, live::Moment deadline) {
  std::vector<std::uint8_t> all(size);
  std::size_t filled = 0;
  while (filled < size && Clock::now() < deadline) {
    const auto got = port.read(std::span{all}.subspan(filled), deadline);
    if (!got) break;
    filled += *got;
  }
  all.resize(filled);
  return all;
}

TEST(PacedLine, CarriesEveryByteBothWaysAndNoneFasterThanItsSpeed) {
  const Echo controller;
  const int port = free_port();
  const PacedLine line{port, controller.port(), 115200};
  Port program = Port::tcp("127.0.0.1", port, Clock::now() + 2s);
  std::vector<std::uint8_t> sent(5760);
  for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = static_cast<std::uint8_t>(i * 7);
  const auto begin = Clock::now();
  ASSERT_TRUE(program.write(sent, Clock::now() + 2s));
  EXPECT_EQ(read_all(program, sent.size(), Clock::now() + 5s), sent);
  // Half a second's bytes at ten bits each, less what a buffer holds at the beginning.
  EXPECT_GT(std::chrono::duration<double>(Clock::now() - begin).count(), 0.47);
  EXPECT_TRUE(line.connected());
}

TEST(PacedLine, HasOneClientAndHangsUpOnASecond) {
  const Echo controller;
  const int port = free_port();
  const PacedLine line{port, controller.port(), 115200};
  Port first = Port::tcp("127.0.0.1", port, Clock::now() + 2s);
  const std::array<std::uint8_t, 3> word{1, 2, 3};
  ASSERT_TRUE(first.write(word, Clock::now() + 1s));
  ASSERT_EQ(read_all(first, 3, Clock::now() + 2s).size(), 3u);
  Port second = Port::tcp("127.0.0.1", port, Clock::now() + 2s);
  std::array<std::uint8_t, 8> room{};
  EXPECT_FALSE(second.read(room, Clock::now() + 2s)) << "closed";
  ASSERT_TRUE(first.write(word, Clock::now() + 1s));
  EXPECT_EQ(read_all(first, 3, Clock::now() + 2s).size(), 3u) << "the first goes on";
}

TEST(PacedLine, APortThatIsTakenIsNamed) {
  const Echo taken;
  try {
    const PacedLine line{taken.port(), 1, 115200};
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string{error.what()}.find(std::to_string(taken.port())), std::string::npos);
  }
}

}  // namespace
}  // namespace gatefly::link_sim
