// SPDX-License-Identifier: Apache-2.0
#pragma once

// Betaflight itself, its simulator target, as a partner of tests: GATEFLY_BETAFLIGHT names its program (tools/autopilots.sh
// builds it), without it they are skipped. It takes the ports that the program has: UDP 9001-9004, TCP 5761.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/link/betaflight_sitl.hpp"
#include "gatefly/link/msp.hpp"
#include "gatefly/link/msp_axes.hpp"
#include "gatefly/link/msp_messages.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::test {

namespace msp = gatefly::msp;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Data = std::vector<std::uint8_t>;

/// Limit of Body::longest_gap() that a machine with a core to spare never reaches.
inline constexpr std::chrono::milliseconds kBusy{8};

// The rates of the AI Grand Prix's qualifier; its throttle curve this version has no more.
inline constexpr const char* kSettings = R"(feature RX_MSP
set rates_type = BETAFLIGHT
set roll_rc_rate = 55
set pitch_rc_rate = 55
set yaw_rc_rate = 57
set roll_srate = 75
set pitch_srate = 75
set yaw_srate = 70
set roll_expo = 0
set pitch_expo = 0
set yaw_expo = 0
set acc_calibration = 0,0,0,1
save
)";

/// The simulator's program; ends with this object.
class Program {
 public:
  Program(const std::string& path, const std::string& folder, std::vector<std::string> flags) {
    flags.insert(flags.begin(), path);
    std::vector<char*> arguments;
    for (std::string& flag : flags) arguments.push_back(flag.data());
    arguments.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    const int nowhere = open("/dev/null", O_WRONLY);
    if (chdir(folder.c_str()) != 0 || dup2(nowhere, 1) < 0 || dup2(nowhere, 2) < 0) _exit(1);
    execv(path.c_str(), arguments.data());
    _exit(1);
  }
  ~Program() {
    if (pid_ > 0) kill(pid_, SIGKILL), waitpid(pid_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Waits for its end; false when it takes too long.
  bool ends_within(std::chrono::seconds limit) {
    for (const auto end = Clock::now() + limit; Clock::now() < end;
         std::this_thread::sleep_for(20ms))
      if (waitpid(pid_, nullptr, WNOHANG) == pid_) return pid_ = 0, true;
    return false;
  }

 private:
  pid_t pid_ = 0;
};

inline sockaddr_in at_port(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

/// A drone in the air that turns as it is told, and feels gravity; a thousand samples a second.
class Body {
 public:
  Body() : socket_{socket(AF_INET, SOCK_DGRAM, 0)}, thread_{[this] { feed(); }} {}
  ~Body() {
    ended_ = true;
    thread_.join();
    close(socket_);
  }
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;

  void turn(const Eigen::Vector3d& rate_B) {
    const std::lock_guard lock{mutex_};
    rate_B_ = rate_B;
  }
  gatefly::Attitude attitude() {
    const std::lock_guard lock{mutex_};
    return gatefly::attitude_of(rotation_EB(q_));
  }

  /// The longest time between two samples since it was last asked. On a busy machine the program's clock, which follows
  /// the stamps, jumps, and what it integrates over time is wrong.
  std::chrono::milliseconds longest_gap() { return std::chrono::milliseconds{gap_ms_.exchange(0)}; }
  std::chrono::milliseconds time() const { return std::chrono::milliseconds{time_ms_}; }
  /// Until so much of its own time has passed.
  void lasts(std::chrono::milliseconds time_span) const {
    for (const auto end = time() + time_span; time() < end;) std::this_thread::sleep_for(1ms);
  }

 private:
  /// Betaflight's clock runs as fast as stamps come: one that is late is not made up for, or its time would jump.
  void feed() {
    const sockaddr_in to = at_port(9003);
    const auto start = Clock::now();
    for (auto last = start; !ended_; std::this_thread::sleep_for(1ms)) {
      const auto now = Clock::now();
      betaflight_sitl::State state;
      state.time = now - start;
      {
        const std::lock_guard lock{mutex_};
        q_ = integrated(q_, rate_B_, std::chrono::duration<double>(now - last).count());
        state.imu.gyro_B = rate_B_;
        state.imu.accel_B = rotation_EB(q_).inverse() * Eigen::Vector3d(0, 0, -kGravity);
        state.attitude = gatefly::attitude_of(rotation_EB(q_));
      }
      const auto gap = std::chrono::duration_cast<std::chrono::milliseconds>(now - last).count();
      gap_ms_ = std::max<std::int64_t>(gap_ms_, gap);
      last = now;
      time_ms_ = std::chrono::duration_cast<std::chrono::milliseconds>(now - start).count();
      const auto bytes = betaflight_sitl::encode_state(state);
      sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
             sizeof to);
    }
  }

  std::mutex mutex_;
  Eigen::Vector3d rate_B_ = Eigen::Vector3d::Zero();
  Quaternion q_;
  std::atomic<bool> ended_ = false;
  std::atomic<std::int64_t> time_ms_ = 0, gap_ms_ = 0;
  int socket_;
  std::thread thread_;
};

/// A client of MSP on TCP.
class Client {
 public:
  ~Client() { disconnect(); }
  void disconnect() {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }
  bool connects_within(std::chrono::seconds limit) {
    for (const auto end = Clock::now() + limit; Clock::now() < end;
         std::this_thread::sleep_for(50ms)) {
      socket_ = socket(AF_INET, SOCK_STREAM, 0);
      const sockaddr_in to = at_port(5761);
      if (connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return true;
      close(socket_);
      socket_ = -1;
    }
    return false;
  }
  /// The answer's payload; nullopt when it is refused or does not come.
  std::optional<Data> ask(std::uint16_t id, const Data& payload = {},
                          msp::Version version = msp::Version::k2) {
    std::array<std::uint8_t, 512> room{};
    const std::size_t size =
        msp::encode_frame({id, payload, msp::Direction::kToController, version}, room);
    if (send(socket_, room.data(), size, MSG_NOSIGNAL) != static_cast<ssize_t>(size)) return {};
    std::optional<Data> answer;
    bool over = false;
    for (const auto end = Clock::now() + 2s; !over && Clock::now() < end;) {
      pollfd ready{socket_, POLLIN, 0};
      if (poll(&ready, 1, 100) <= 0) continue;
      const ssize_t got = recv(socket_, room.data(), room.size(), 0);
      if (got <= 0) break;
      stream_.feed(link::Bytes{room}.first(static_cast<std::size_t>(got)),
                   [&](const msp::Frame& frame) {
                     if (frame.id != id) return;
                     over = true;
                     if (frame.direction == msp::Direction::kFromController)
                       answer = Data(frame.payload.begin(), frame.payload.end());
                   });
    }
    return answer;
  }
  template <class Message>
  std::optional<Message> ask() {
    const auto payload = ask(Message::kId);
    return payload ? link::decoded<Message>(*payload) : std::nullopt;
  }
  [[nodiscard]] std::uint64_t skipped() const { return stream_.skipped(); }

 private:
  int socket_ = -1;
  msp::Stream stream_;
};

/// A drone that floats in the air until it is told to turn, and a client that talks to it.
class RealBetaflight : public testing::Test {
 protected:
  void SetUp() override {
    const char* path = std::getenv("GATEFLY_BETAFLIGHT");
    if (path == nullptr)
      GTEST_SKIP()
          << "GATEFLY_BETAFLIGHT does not name Betaflight's simulator: see tools/autopilots.sh";
    std::ofstream{folder_.path() / "settings.txt"} << kSettings;
    Program settings{path, folder_.path().string(), {"--config", "settings.txt"}};
    ASSERT_TRUE(settings.ends_within(20s));
    program_.emplace(path, folder_.path().string(), std::vector<std::string>{});
    // Samples not before it listens: while it starts they set its clock, and with it how long it waits for itself.
    ASSERT_TRUE(client_.connects_within(20s));
    body_.emplace();
    body_->lasts(4s);  // it wants to see a gyro at rest
  }
  void TearDown() override {
    // The client first: who ends a connection keeps its port busy for a while.
    client_.disconnect();
    std::this_thread::sleep_for(50ms);
    body_.reset();
    program_.reset();
  }
  Imu imu() {
    const auto raw = client_.ask<msp::RawImu>();
    return raw ? msp::imu_of(*raw, {.accel_counts_per_g = 256.0}) : Imu{};
  }
  gatefly::Attitude attitude() {
    const auto attitude = client_.ask<msp::Attitude>();
    return attitude ? msp::attitude_of(*attitude) : gatefly::Attitude{9, 9, 9};
  }

  TempFolder folder_;
  std::optional<Program> program_;
  std::optional<Body> body_;
  Client client_;
};

}  // namespace gatefly::test
