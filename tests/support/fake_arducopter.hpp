// SPDX-License-Identifier: Apache-2.0
#pragma once

// An ArduCopter with a drone below it, for tests: MAVLink 2 on TCP, or by UDP to a program that listens. As the real one does, it flies
// by set points in GUIDED_NOGPS alone, and a second after the last one it is level and holds its height.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "gatefly/geometry/rng.hpp"
#include "gatefly/link/mavlink.hpp"
#include "gatefly/link/mavlink_axes.hpp"
#include "gatefly/link/mavlink_commands.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"

#include "support/fake_body.hpp"

namespace gatefly::test {

struct FakeArduSettings {
  double hover_error = 0.0;   ///< Part by which the rotors give more than the parameters say.
  double start_height = 0.0;  ///< Held there until it is handed over [m].
  double hover = 0.2;         ///< MOT_THST_HOVER.
  std::string log{};          ///< A CSV of every set point, and of the drone's motion.
  int port = 0;               ///< TCP port; 0: any that is free.
  int calls = 0;              ///< UDP port of 127.0.0.1 that it calls instead; 0: none.
};

/// One drone, from its start to the end of the test. Everything happens in serve(), which may be another thread's.
class FakeArduCopter {
 public:
  using Clock = std::chrono::steady_clock;

  explicit FakeArduCopter(const FakeArduSettings& settings)
      : settings_{settings}, start_{Clock::now()} {
    parameters_ = {{"GUID_OPTIONS", 8},
                   {"GUID_TIMEOUT", 1},
                   {"MOT_THST_HOVER", static_cast<float>(settings.hover)},
                   {"MOT_THST_EXPO", 1},
                   {"MOT_SPIN_MIN", 0},
                   {"MOT_SPIN_MAX", 1},
                   {"ATC_ANGLE_BOOST", 0}};
    if (settings.calls > 0)
      call();
    else
      await();
    if (!settings_.log.empty()) log_.open(settings_.log);
    log_ << "t_s,what,p_radps,q_radps,r_radps,thrust,armed,override,x_m,y_m,z_m,vx_mps,vy_mps,vz_"
            "mps\n";
    body_.p_E.z() = -settings_.start_height;
  }
  virtual ~FakeArduCopter() {
    if (client_ >= 0) close(client_);
    if (listener_ >= 0) close(listener_);
  }
  FakeArduCopter(const FakeArduCopter&) = delete;
  FakeArduCopter& operator=(const FakeArduCopter&) = delete;

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] int set_points() const {
    const std::lock_guard lock{mutex_};
    return set_points_;
  }
  /// Commands that change something: a program that flies has no business with any.
  [[nodiscard]] int meddled() const {
    const std::lock_guard lock{mutex_};
    return meddled_;
  }

  /// Words for the radio and for faults: "arm", "disarm", "override on" (GUIDED_NOGPS), "override off" (STABILIZE), "land" (its own
  /// mode), "freeze imu", "cut", "mark", "turn 0" (by hand, a quarter about an axis and back), "invert pitch", "swap axes",
  /// "gyro scale 2", "no accelerometer", "other" (another computer aboard), "twin" (one with our name), "station" (a ground station),
  /// "silent", "coarse" (no HIGHRES_IMU), "battery 18.5", "parameter NAME VALUE", "deaf" (to set points), "pitch obeyed inverted",
  /// "holds on" (to the last set point, for ever). False: no such word.
  bool obey(const std::string& word) {
    const std::lock_guard lock{mutex_};
    if (word == "arm")
      armed_ = true;
    else if (word == "disarm")
      armed_ = false;
    else if (word == "override on")
      mode_ = mavlink::kGuidedNoGps, guided_at_ = seconds();
    else if (word == "override off")
      mode_ = 0;
    else if (word == "land")
      mode_ = 9;
    else if (word == "freeze imu")
      frozen_ = true;
    else if (word == "cut")
      drop_client();
    else if (word == "mark")
      marked_ = true;  // for the log alone
    else if (word.starts_with("turn "))
      turn_axis_ = std::stoi(word.substr(5)), turned_from_ = seconds();
    else if (word == "invert pitch")
      inverted_ = true;
    else if (word == "swap axes")
      swapped_ = true;
    else if (word.starts_with("gyro scale "))
      gyro_part_ = std::stod(word.substr(11));
    else if (word == "no accelerometer")
      no_accel_ = true;
    else if (word == "other")
      other_ = mavlink::Sender{1, 192, 0}, other_type_ = 18;
    else if (word == "twin")
      other_ = mavlink::Sender{1, 191, 0}, other_type_ = 30;
    else if (word == "station")
      other_ = mavlink::Sender{255, 190, 0}, other_type_ = 6;
    else if (word == "silent")
      silent_ = true;
    else if (word == "deaf")
      deaf_ = true;
    else if (word == "pitch obeyed inverted")
      obeys_inverted_ = true;
    else if (word == "holds on")
      holds_on_ = true;
    else if (word == "coarse")
      coarse_ = true;
    else if (word.starts_with("battery "))
      battery_v_ = std::stod(word.substr(8));
    else if (word.starts_with("parameter ")) {
      const auto space = word.find(' ', 10);
      parameters_[word.substr(10, space - 10)] = std::stof(word.substr(space + 1));
    } else
      return false;
    write_log(word.c_str());
    return true;
  }

  /// A millisecond's work, or what the clock asks for.
  void serve() {
    const std::lock_guard lock{mutex_};
    const double now = seconds();
    for (; last_ + kStep <= now; last_ += kStep) move(kStep);
    receive();  // also that one has gone, before the next one comes
    accept_client();
    transmit(now);
    if (now - logged_ < 0.02) return;
    logged_ = now;
    write_log("state");
    log_.flush();
  }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

 protected:
  static constexpr double kStep = 0.001;

  /// Source of its commands: a program, or its own when that is silent, or when the radio flies.
  struct Obeyed {
    Eigen::Vector3d rates_B = Eigen::Vector3d::Zero();
    double thrust = 0.0;  ///< 0 … 1
  };
  [[nodiscard]] Obeyed obeyed() const {
    Obeyed is;
    if (!armed_ || mode_ != mavlink::kGuidedNoGps || deaf_) return is;
    if (holds_on_ || seconds() - target_at_ <= parameters_.at("GUID_TIMEOUT")) {
      is.rates_B = {target_.body_roll_rate, target_.body_pitch_rate, target_.body_yaw_rate};
      if (obeys_inverted_) is.rates_B.y() *= -1;
      is.thrust = target_.thrust;
      return is;
    }
    if (target_at_ < guided_at_) return is;  // on the floor, nobody has spoken yet
    const gatefly::Attitude attitude = attitude_of(rotation_EB(body_.q));
    is.rates_B = {-4 * attitude.roll, -4 * attitude.pitch, 0};
    is.thrust = settings_.hover;
    return is;
  }
  /// Its own motion; of a simulator that of somebody else's physics.
  virtual void move(double dt) {
    const Obeyed is = obeyed();
    const bool handed_over = armed_ && mode_ == mavlink::kGuidedNoGps;
    released_ = released_ || handed_over;
    const double before = body_.p_E.z();
    if (const double since = seconds() - turned_from_; since < 2.0)
      return body_.turn(turn_axis_, (since < 1.0 ? 90 : -90) * kDegree, dt);
    const bool held = settings_.start_height > 0 && !released_;
    body_.step(is.rates_B, kGravity * (1 + settings_.hover_error) * is.thrust / settings_.hover,
               held, dt);
    if (body_.p_E.z() >= 0 && before < 0) write_log("touch");
  }

  void await() {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_in at = here(settings_.port);
    const int yes = 1;
    if (listener_ >= 0) setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    socklen_t size = sizeof at;
    if (listener_ < 0 || bind(listener_, reinterpret_cast<const sockaddr*>(&at), size) != 0 ||
        listen(listener_, 4) != 0 ||
        getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size) != 0)
      throw std::runtime_error("the fake cannot listen");
    port_ = ntohs(at.sin_port);
  }
  void call() {
    client_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const sockaddr_in to = here(settings_.calls);
    if (client_ < 0 || connect(client_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
      throw std::runtime_error("the fake cannot call");
  }
  static sockaddr_in here(int port) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    at.sin_port = htons(static_cast<std::uint16_t>(port));
    return at;
  }
  void accept_client() {
    if (listener_ < 0) return;
    const int fd = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd < 0) return;
    if (client_ >= 0) {
      close(fd);
      return;
    }
    const int yes = 1;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    client_ = fd;
    stream_.restart();
    streams_ = {{mavlink::Heartbeat::kId, {1.0, 0.0}}};  // as a controller does by itself
  }
  void drop_client() {
    if (client_ >= 0) close(client_);
    client_ = -1;
  }
  void receive() {
    std::array<std::uint8_t, 2048> room{};
    while (client_ >= 0) {
      const ssize_t got = recv(client_, room.data(), room.size(), 0);
      if (got == 0 && listener_ >= 0) return drop_client();
      if (got <= 0) return;
      stream_.feed(link::Bytes{room}.first(static_cast<std::size_t>(got)),
                   [&](const mavlink::Frame& frame) { hear(frame); });
    }
  }
  template <class Message>
  void say(const Message& message, const mavlink::Sender& sender = {1, 1, 0}) {
    if (client_ < 0 || silent_) return;
    std::array<std::uint8_t, mavlink::kLongestFrame> room{};
    const std::size_t size =
        mavlink::encode_message(message, {sender.system, sender.component, sequence_++}, room);
    (void)!send(client_, room.data(), size, MSG_NOSIGNAL);
  }
  void hear(const mavlink::Frame& frame) {
    if (const auto command = mavlink::message_in<mavlink::CommandLong>(frame)) obey(*command);
    if (mavlink::message_in<mavlink::ParamSet>(frame)) ++meddled_;
    if (const auto question = mavlink::message_in<mavlink::ParamRequestRead>(frame)) {
      const std::string name{question->param_id.data(),
                             strnlen(question->param_id.data(), question->param_id.size())};
      if (!parameters_.contains(name)) return;
      say(mavlink::ParamValue{.param_value = parameters_[name],
                              .param_count = 7,
                              .param_index = 65535,
                              .param_id = question->param_id,
                              .param_type = 9});
    }
    if (const auto question = mavlink::message_in<mavlink::Timesync>(frame))
      if (const auto answer = mavlink::clock_answer(*question, nanoseconds())) say(*answer);
    if (const auto target = mavlink::message_in<mavlink::SetAttitudeTarget>(frame)) take(*target);
  }
  void take(const mavlink::SetAttitudeTarget& target) {
    ++set_points_;
    sent_ = target;
    if (mode_ == mavlink::kGuidedNoGps) target_ = target, target_at_ = seconds();
    write_log("frame");
  }
  void obey(const mavlink::CommandLong& command) {
    const auto message = static_cast<std::uint32_t>(command.param1);
    const bool known = !(coarse_ && message == mavlink::HighresImu::kId);
    if (command.command == 511 && known)
      streams_[message] = {1e-6 * command.param2, seconds()};
    else if (command.command == 512)
      tell(message);
    else if (command.command == 176 || command.command == 400)
      ++meddled_;
    say(mavlink::CommandAck{.command = command.command,
                            .result = static_cast<std::uint8_t>(known ? 0 : 3)});
  }
  /// Its clock began a hundred seconds before the test.
  [[nodiscard]] std::chrono::nanoseconds nanoseconds() const {
    return std::chrono::nanoseconds{std::llround(1e9 * (seconds() + 100))};
  }
  void transmit(double now) {
    if (client_ >= 0 && streams_.empty()) streams_[mavlink::Heartbeat::kId] = {1.0, 0.0};
    for (auto& [message, stream] : streams_) {
      if (now < stream.due) continue;
      stream.due = std::max(stream.due + stream.interval, now);
      tell(message);
    }
    if (!other_ || now - other_at_ < 0.5) return;
    other_at_ = now;
    say(mavlink::Heartbeat{.type = other_type_, .autopilot = 8, .mavlink_version = 3}, *other_);
  }
  [[nodiscard]] Imu felt() {
    if (frozen_ && felt_) return *felt_;
    Imu imu{gyro(), force()};
    const auto noise = [this] { return rng_.uniform(-1.7, 1.7); };
    for (int i = 0; i < 3; ++i) imu.gyro_B[i] += 0.003 * noise(), imu.accel_B[i] += 0.05 * noise();
    if (swapped_) std::swap(imu.gyro_B.x(), imu.gyro_B.y());
    if (inverted_) imu.gyro_B.y() *= -1;
    imu.gyro_B *= gyro_part_;
    if (no_accel_) imu.accel_B.setZero();
    felt_ = imu;
    return imu;
  }
  [[nodiscard]] virtual Eigen::Vector3d gyro() const { return body_.rates_B; }
  [[nodiscard]] virtual Eigen::Vector3d force() const { return body_.force_B(); }
  void tell(std::uint32_t message) {
    const auto ms = static_cast<std::uint32_t>(nanoseconds().count() / 1'000'000);
    const auto us = static_cast<std::uint64_t>(nanoseconds().count() / 1'000);
    const auto f = [](double value) { return static_cast<float>(value); };
    if (message == mavlink::Heartbeat::kId) {
      const bool flies = body_.p_E.z() < -0.05;
      say(mavlink::Heartbeat{.custom_mode = mode_,
                             .type = 2,
                             .autopilot = 3,
                             .base_mode = static_cast<std::uint8_t>(armed_ ? 129 : 1),
                             .system_status = static_cast<std::uint8_t>(flies ? 4 : 3),
                             .mavlink_version = 3});
    } else if (message == mavlink::SysStatus::kId) {
      say(mavlink::SysStatus{
          .onboard_control_sensors_present = 3,
          .onboard_control_sensors_enabled = 3,
          .onboard_control_sensors_health = no_accel_ ? 1u : 3u,
          .voltage_battery = static_cast<std::uint16_t>(std::lround(1e3 * battery_v_))});
    } else if (message == mavlink::AutopilotVersion::kId) {
      say(mavlink::AutopilotVersion{.flight_sw_version = 0x04070000});
    } else if (message == mavlink::Attitude::kId) {
      const gatefly::Attitude is = attitude_of(rotation_EB(body_.q));
      say(mavlink::Attitude{ms, f(is.roll), f(is.pitch), f(is.yaw)});
    } else if (message == mavlink::AttitudeTarget::kId) {
      const Obeyed is = obeyed();
      say(mavlink::AttitudeTarget{.time_boot_ms = ms,
                                  .body_roll_rate = f(is.rates_B.x()),
                                  .body_pitch_rate = f(is.rates_B.y()),
                                  .body_yaw_rate = f(is.rates_B.z()),
                                  .thrust = f(is.thrust)});
    } else if (message == mavlink::HighresImu::kId) {
      const Imu imu = felt();
      say(mavlink::HighresImu{us, f(imu.accel_B.x()), f(imu.accel_B.y()), f(imu.accel_B.z()),
                              f(imu.gyro_B.x()), f(imu.gyro_B.y()), f(imu.gyro_B.z())});
    } else if (message == mavlink::RawImu::kId) {
      const Imu imu = felt();
      const auto thousandths = [](double value) {
        return static_cast<std::int16_t>(std::lround(1e3 * value));
      };
      const Eigen::Vector3d g = imu.accel_B / kGravity;
      say(mavlink::RawImu{us, thousandths(g.x()), thousandths(g.y()), thousandths(g.z()),
                          thousandths(imu.gyro_B.x()), thousandths(imu.gyro_B.y()),
                          thousandths(imu.gyro_B.z())});
    }
  }
  void write_log(const char* what) {
    if (!log_.is_open()) return;
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(),
                  "%.4f,%s,%.3f,%.3f,%.3f,%.4f,%d,%d,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f\n", seconds(),
                  what, double(sent_.body_roll_rate), double(sent_.body_pitch_rate),
                  double(sent_.body_yaw_rate), double(sent_.thrust), armed_,
                  mode_ == mavlink::kGuidedNoGps, body_.p_E.x(), body_.p_E.y(), body_.p_E.z(),
                  body_.v_E.x(), body_.v_E.y(), body_.v_E.z());
    log_ << line.data();
  }

  struct Streamed {
    double interval = 0.0, due = 0.0;  ///< [s]
  };
  mutable std::mutex mutex_;
  FakeArduSettings settings_;
  Clock::time_point start_;
  std::ofstream log_;
  std::map<std::string, float> parameters_;
  std::map<std::uint32_t, Streamed> streams_;
  int listener_ = -1, client_ = -1, port_ = 0, set_points_ = 0, meddled_ = 0, turn_axis_ = 0;
  std::uint8_t sequence_ = 0, other_type_ = 0;
  std::uint32_t mode_ = 0;
  mavlink::Stream stream_;
  mavlink::SetAttitudeTarget sent_, target_;
  std::optional<mavlink::Sender> other_;
  double last_ = 0, logged_ = 0, target_at_ = -100, guided_at_ = -10, other_at_ = 0,
         battery_v_ = 24.0, turned_from_ = -10.0, gyro_part_ = 1.0;
  bool armed_ = false, frozen_ = false, released_ = false, silent_ = false, coarse_ = false,
       inverted_ = false, swapped_ = false, no_accel_ = false, marked_ = false, deaf_ = false,
       obeys_inverted_ = false, holds_on_ = false;
  std::optional<Imu> felt_;
  FakeBody body_;
  Rng rng_{1};
};

}  // namespace gatefly::test
