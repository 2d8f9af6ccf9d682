// SPDX-License-Identifier: Apache-2.0
// MSP against Betaflight itself: GATEFLY_BETAFLIGHT names its simulator's program (tools/autopilots.sh builds it).
// It takes the ports that the program has: UDP 9001-9004, TCP 5761.
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
#include <gmock/gmock.h>
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
#include "gatefly/link/msp_lists.hpp"
#include "gatefly/link/msp_messages.hpp"
#include "gatefly/link/rate_curve.hpp"
#include "gatefly/link/throttle_curve.hpp"

#include "support/matchers.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::msp {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Data = std::vector<std::uint8_t>;
using Eigen::Vector3d;
using test::IsNear;

// The rates of the AI Grand Prix's qualifier; its throttle curve this version has no more.
constexpr const char* kSettings = R"(feature RX_MSP
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

sockaddr_in at_port(std::uint16_t port) {
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

  void turn(const Vector3d& rate_B) {
    const std::lock_guard lock{mutex_};
    rate_B_ = rate_B;
  }
  gatefly::Attitude attitude() {
    const std::lock_guard lock{mutex_};
    return gatefly::attitude_of(rotation_EB(q_));
  }

 private:
  void feed() {
    const sockaddr_in to = at_port(9003);
    const auto start = Clock::now();
    // Its clock runs as fast as stamps come: one that is late is not made up for, or its time would jump.
    for (auto last = start; !ended_; std::this_thread::sleep_for(1ms)) {
      const auto now = Clock::now();
      betaflight_sitl::State state;
      state.time = now - start;
      {
        const std::lock_guard lock{mutex_};
        q_ = integrated(q_, rate_B_, std::chrono::duration<double>(now - last).count());
        state.imu.gyro_B = rate_B_;
        state.imu.accel_B = rotation_EB(q_).inverse() * Vector3d(0, 0, -kGravity);
        state.attitude = gatefly::attitude_of(rotation_EB(q_));
      }
      last = now;
      const auto bytes = betaflight_sitl::encode_state(state);
      sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
             sizeof to);
    }
  }

  std::mutex mutex_;
  Vector3d rate_B_ = Vector3d::Zero();
  Quaternion q_;
  std::atomic<bool> ended_ = false;
  int socket_;
  std::thread thread_;
};

/// A client of MSP on TCP.
class Client {
 public:
  ~Client() {
    if (socket_ >= 0) close(socket_);
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
                          Version version = Version::k2) {
    std::array<std::uint8_t, 512> room{};
    const std::size_t size = encode_frame({id, payload, Direction::kToController, version}, room);
    if (send(socket_, room.data(), size, MSG_NOSIGNAL) != static_cast<ssize_t>(size)) return {};
    std::optional<Data> answer;
    bool over = false;
    for (const auto end = Clock::now() + 2s; !over && Clock::now() < end;) {
      pollfd ready{socket_, POLLIN, 0};
      if (poll(&ready, 1, 100) <= 0) continue;
      const ssize_t got = recv(socket_, room.data(), room.size(), 0);
      if (got <= 0) break;
      stream_.feed(link::Bytes{room}.first(static_cast<std::size_t>(got)), [&](const Frame& frame) {
        if (frame.id != id) return;
        over = true;
        if (frame.direction == Direction::kFromController)
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
  Stream stream_;
};

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
    body_.emplace();
    ASSERT_TRUE(client_.connects_within(20s));
    std::this_thread::sleep_for(4s);  // it wants to see a gyro at rest
  }
  void TearDown() override {
    body_.reset();
    program_.reset();
  }
  Imu imu() {
    const auto raw = client_.ask<RawImu>();
    return raw ? imu_of(*raw, {.accel_counts_per_g = 256.0}) : Imu{};
  }
  gatefly::Attitude attitude() {
    const auto attitude = client_.ask<Attitude>();
    return attitude ? attitude_of(*attitude) : gatefly::Attitude{9, 9, 9};
  }

  test::TempFolder folder_;
  std::optional<Program> program_;
  std::optional<Body> body_;
  Client client_;
};

TEST_F(RealBetaflight, SaysWhoItIsAndHowItIsSet) {
  const auto variant = client_.ask<FcVariant>();
  ASSERT_TRUE(variant);
  EXPECT_THAT(variant->name, testing::ElementsAre('B', 'T', 'F', 'L'));
  const auto api = client_.ask<ApiVersion>();
  ASSERT_TRUE(api);
  EXPECT_EQ(api->major, 1);
  EXPECT_GE(api->minor, 45);
  ASSERT_TRUE(client_.ask<FcVersion>());

  const auto tuning = client_.ask<RcTuning>();
  const auto receiver = client_.ask<RxConfig>();
  const auto deadband = client_.ask<RcDeadband>();
  ASSERT_TRUE(tuning && receiver && deadband);
  const auto profile = RateProfile::from(*tuning, *deadband, *receiver);
  ASSERT_TRUE(profile);
  EXPECT_NEAR(profile->roll.rate(2000) / kDegree, 440, 1e-9);
  EXPECT_NEAR(profile->pitch.rate(1750) / kDegree, 88, 1e-9);
  EXPECT_NEAR(profile->yaw.rate(2000) / kDegree, 380, 1e-9);
  EXPECT_EQ(ThrottleCurve::from(*tuning, *receiver).has_value(), api->minor < 47);

  const auto map = client_.ask<RxMap>();
  ASSERT_TRUE(map);
  EXPECT_TRUE(ChannelOrder::from(*map));
  EXPECT_TRUE(client_.ask<BatteryState>() && client_.ask<Analog>() && client_.ask<Altitude>());

  // The same question in the other version has the same answer; one that nobody knows is refused.
  EXPECT_EQ(client_.ask(RcTuning::kId, {}, Version::k1), client_.ask(RcTuning::kId));
  EXPECT_FALSE(client_.ask(0x3FFF));
  EXPECT_EQ(client_.skipped(), 0u);
}

TEST_F(RealBetaflight, TellsModesAndAnswersSeveralQuestionsInOneFrame) {
  const auto id_bytes = client_.ask(kBoxIds);
  const auto names = client_.ask(kBoxNames);
  ASSERT_TRUE(id_bytes && names);
  const auto ids = box_ids_in(*id_bytes);
  ASSERT_TRUE(ids);
  for (std::size_t i = 0; i < ids->size(); ++i) {
    const std::string_view name = box_name_in(*names, i);
    EXPECT_NE(name, "");
    EXPECT_EQ(name == "ARM", (*ids)[i] == static_cast<std::uint8_t>(Box::kArm));
    EXPECT_EQ(name == "ANGLE", (*ids)[i] == static_cast<std::uint8_t>(Box::kAngle));
    EXPECT_EQ(name == "FAILSAFE", (*ids)[i] == static_cast<std::uint8_t>(Box::kFailsafe));
    EXPECT_EQ(name == "MSP OVERRIDE", (*ids)[i] == static_cast<std::uint8_t>(Box::kMspOverride));
  }
  const auto ranges = client_.ask(kModeRanges);
  ASSERT_TRUE(ranges);
  EXPECT_TRUE(mode_ranges_in(*ranges));

  const Data questions{108, 102, 150, 105};
  const auto together = client_.ask(kMultiple, questions);
  ASSERT_TRUE(together);
  std::vector<int> answered;
  EXPECT_TRUE(each_answer(questions, *together, [&](std::uint16_t id, link::Bytes payload) {
    answered.push_back(id);
    if (id == kStatusEx) {
      const auto status = status_in(payload);
      ASSERT_TRUE(status);
      EXPECT_EQ(status->on(Box::kArm, *ids), false);
      EXPECT_TRUE(status->gyro && status->accelerometer);
      EXPECT_NE(status->arming_refused, 0u) << "there is no receiver yet";
    }
  }));
  EXPECT_THAT(answered, testing::ElementsAre(108, 102, 150, 105));
}

TEST_F(RealBetaflight, FliesByTheSticksThatAreSentInItsOrder) {
  const auto map = client_.ask<RxMap>();
  ASSERT_TRUE(map);
  const auto order = ChannelOrder::from(*map);
  ASSERT_TRUE(order);
  const Sticks sticks{.roll = 1601, .pitch = 1402, .yaw = 1553, .throttle = 1104};
  const auto sent = order->set_raw_rc(sticks);
  for (int i = 0; i < 25; ++i) {
    ASSERT_TRUE(client_.ask(kSetRawRc, {sent.begin(), sent.end()}));
    std::this_thread::sleep_for(20ms);
  }
  const auto rc = client_.ask(kRc);
  ASSERT_TRUE(rc);
  const auto channels = channels_in(*rc);
  ASSERT_TRUE(channels);
  EXPECT_EQ(sticks_in_rc({channels->begin(), channels->size()}), sticks);
}

TEST_F(RealBetaflight, TurnsAreOursInUnitAndSignOnGyroAccelerometerAndAttitude) {
  EXPECT_THAT(imu().accel_B, IsNear(Vector3d(0, 0, -kGravity), 0.1));
  EXPECT_THAT(imu().gyro_B, IsNear(Vector3d(0, 0, 0), 0.01));
  EXPECT_NEAR(attitude().yaw, 0.0, 4 * kDegree);
  // Right side down, nose up, nose right, one after the other, and back.
  const std::array<Vector3d, 3> turns{{{0.8, 0, 0}, {0, 0.8, 0}, {0, 0, 0.8}}};
  for (const Vector3d& rate_B : turns) {
    SCOPED_TRACE(rate_B.transpose());
    body_->turn(rate_B);
    std::this_thread::sleep_for(300ms);
    EXPECT_THAT(imu().gyro_B, IsNear(rate_B, 0.02));
    std::this_thread::sleep_for(200ms);
    body_->turn({0, 0, 0});
    std::this_thread::sleep_for(100ms);
    const gatefly::Attitude truth = body_->attitude(), said = attitude();
    EXPECT_NEAR(said.roll, truth.roll, 3 * kDegree);
    EXPECT_NEAR(said.pitch, truth.pitch, 3 * kDegree);
    EXPECT_NEAR(wrap_angle(said.yaw - truth.yaw), 0.0, 4 * kDegree);
    EXPECT_THAT(imu().accel_B,
                IsNear(Vector3d(rotation_EB(truth).inverse() * Vector3d(0, 0, -kGravity)), 0.1));
    body_->turn(-rate_B);
    std::this_thread::sleep_for(500ms);
    body_->turn({0, 0, 0});
    std::this_thread::sleep_for(100ms);
  }
}

}  // namespace
}  // namespace gatefly::msp
