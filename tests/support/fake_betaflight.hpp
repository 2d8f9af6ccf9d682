// SPDX-License-Identifier: Apache-2.0
#pragma once

// A Betaflight 4.4.3 with a drone below it, for tests: MSP on TCP, paced to a serial line's speed. As that version does, it obeys the
// last stick frame for ever while the override is on; before the first one its buffer is zeros, and it fails safe.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <deque>
#include <fstream>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rng.hpp"
#include "gatefly/link/msp.hpp"
#include "gatefly/link/msp_axes.hpp"
#include "gatefly/link/msp_lists.hpp"
#include "gatefly/link/msp_messages.hpp"
#include "gatefly/link/rate_curve.hpp"
#include "gatefly/link/throttle_curve.hpp"

namespace gatefly::test {

/// The constants of the fake, as its controller answers them; tests/live/fake_drone.toml says the same.
struct FakeConstants {
  msp::RcTuning tuning{.roll_rc_rate = 20,
                       .super_rate = {45, 45, 40},
                       .throttle_mid = 54,
                       .throttle_expo = 68,
                       .yaw_rc_rate = 18,
                       .pitch_rc_rate = 20,
                       .throttle_limit_percent = 100,
                       .rate_limit = {1998, 1998, 1998},
                       .rates_type = 3};
  msp::RcDeadband deadband{.roll_and_pitch = 2, .yaw = 3};
  msp::RxConfig receiver{
      .max_check = 1900, .mid = 1500, .min_check = 1050, .least_pulse = 885, .longest_pulse = 2115};
  msp::RxMap map{.place = {0, 1, 3, 2, 4, 5, 6, 7}};
  msp::ImuScale imu;
  int hover_stick = 1425;  ///< [µs]
  double exponent = 1.6;   ///< Power of thrust over throttle.
};

struct FakeSettings {
  int baud = 115200;
  double hover_error = 0.0;   ///< Part by which the rotors give more than the constants say.
  double start_height = 0.0;  ///< Held there until the override is on [m].
  std::string log;            ///< A CSV of every stick frame, and of the drone's motion.
  int port = 0;               ///< TCP port of its serial line; 0: any that is free.
};

/// One drone, from its start to the end of the test. Everything happens in serve(), which may be another thread's.
class FakeBetaflight {
 public:
  using Clock = std::chrono::steady_clock;

  explicit FakeBetaflight(const FakeSettings& settings, const FakeConstants& constants = {})
      : settings_{settings}, constants_{constants}, start_{Clock::now()} {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    at.sin_port = htons(static_cast<std::uint16_t>(settings_.port));
    const int yes = 1;
    if (listener_ >= 0) setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    socklen_t size = sizeof at;
    if (listener_ < 0 || bind(listener_, reinterpret_cast<const sockaddr*>(&at), size) != 0 ||
        listen(listener_, 4) != 0 ||
        getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size) != 0)
      throw std::runtime_error("the fake cannot listen");
    port_ = ntohs(at.sin_port);
    if (!settings_.log.empty()) log_.open(settings_.log);
    log_ << "t_s,what,roll,pitch,throttle,yaw,armed,override,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps\n";
    z_ = -settings_.start_height;
  }
  virtual ~FakeBetaflight() {
    if (client_ >= 0) close(client_);
    close(listener_);
  }
  FakeBetaflight(const FakeBetaflight&) = delete;
  FakeBetaflight& operator=(const FakeBetaflight&) = delete;

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] int frames() const {
    const std::lock_guard lock{mutex_};
    return frames_;
  }

  /// Words for the radio and for faults: "arm", "disarm", "override on", "override off", "freeze imu", "cut",
  /// "mark", "turn 0" (by hand, a quarter about an axis and back), "swap axes", "invert pitch",
  /// "gyro scale 2", "no accelerometer", "saturate", "bus errors", "strange" (answers that nobody asked for), "late 1.5" (so long it sends answers of an earlier client), "battery 18.5", "silent" (no answers);
  /// for what becomes of stick frames: "deaf" (acknowledged and not obeyed), "no yaw" (obeyed but for yaw), "channels swapped" (yaw and throttle),
  /// "sticks frozen" (the first that are not neutral are kept), "override stuck" (obeyed when it is off, too), "unacknowledged",
  /// "forgets" (after 0.3 s, as later versions do), "failsafe" (after that its own sticks). False: no such word.
  bool obey(const std::string& word) {
    const std::lock_guard lock{mutex_};
    if (word == "arm")
      armed_ = true;
    else if (word == "disarm")
      armed_ = false;
    else if (word == "override on")
      override_ = overridden_ = true, override_at_ = seconds();
    else if (word == "override off")
      override_ = false;
    else if (word == "freeze imu")
      frozen_ = true;
    else if (word == "strange")
      strange_ = 3;
    else if (word.starts_with("late "))
      late_until_ = seconds() + std::stod(word.substr(5));
    else if (word == "silent")
      silent_ = true;
    else if (word == "cut")
      drop_client();
    else if (word == "mark")
      marked_ = true;  // for the log alone
    else if (word.starts_with("turn "))
      turn_axis_ = std::stoi(word.substr(5)), turned_from_ = seconds();
    else if (word == "swap axes")
      swapped_ = true;
    else if (word == "invert pitch")
      inverted_ = true;
    else if (word.starts_with("gyro scale "))
      gyro_part_ = std::stod(word.substr(11));
    else if (word == "no accelerometer")
      no_accel_ = true;
    else if (word == "saturate")
      saturated_ = true;
    else if (word == "bus errors")
      bus_errors_ = 12;
    else if (word == "deaf")
      deaf_ = true;
    else if (word == "no yaw")
      yaws_ = false;
    else if (word == "channels swapped")
      channels_swapped_ = true;
    else if (word == "sticks frozen")
      sticks_frozen_ = true;
    else if (word == "override stuck")
      override_stuck_ = true;
    else if (word == "unacknowledged")
      acknowledges_ = false;
    else if (word == "forgets")
      forgets_ = true;
    else if (word == "failsafe")
      fails_safe_ = true;
    else if (word.starts_with("battery "))
      battery_v_ = std::stod(word.substr(8));
    else
      return false;
    write_log(word.c_str());
    return true;
  }

  /// A millisecond's work, or what the clock asks for.
  void serve() {
    const std::lock_guard lock{mutex_};
    const double now = seconds();
    for (; last_ + kStep <= now; last_ += kStep) move(kStep);
    accept_client();
    if (now < late_until_ && now - late_at_ > 0.02)
      late_at_ = now, reply(msp::kSetRawRc, {}, msp::Version::k1);
    receive(now);
    transmit(now);
    if (now - logged_ >= 0.02) logged_ = now, write_log("state");
    if (now - logged_ >= 0 && log_.is_open()) log_.flush();
  }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

 protected:
  static constexpr double kStep = 0.001;

  void accept_client() {
    const int fd = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd < 0) return;
    if (client_ >= 0) {  // a second one: of a serial line there is but one end
      close(fd);
      return;
    }
    const int yes = 1;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    client_ = fd;
    stream_.restart();
    out_.clear();
  }
  void drop_client() {
    if (client_ >= 0) close(client_);
    client_ = -1;
  }

  /// Bytes come, and go, as fast as the line's speed lets them.
  [[nodiscard]] std::size_t allowance(double& since, double now) const {
    const double per_second = settings_.baud / 10.0;
    const double bytes = std::min((now - since) * per_second, 0.02 * per_second);
    const auto whole = static_cast<std::size_t>(std::max(0.0, bytes));
    if (whole > 0) since = now - (bytes - static_cast<double>(whole)) / per_second;
    return whole;
  }
  void receive(double now) {
    if (client_ < 0) return;
    std::array<std::uint8_t, 512> room{};
    const std::size_t most = std::min(room.size(), allowance(received_, now));
    if (most == 0) return;
    const ssize_t got = recv(client_, room.data(), most, 0);
    if (got == 0) return drop_client();
    if (got > 0)
      stream_.feed(link::Bytes{room}.first(static_cast<std::size_t>(got)),
                   [&](const msp::Frame& frame) { answer(frame); });
  }
  void transmit(double now) {
    const std::size_t most = std::min(out_.size(), allowance(sent_, now));
    if (client_ < 0 || most == 0) return;
    const std::vector<std::uint8_t> bytes(out_.begin(),
                                          out_.begin() + static_cast<std::ptrdiff_t>(most));
    const ssize_t put = send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (put > 0) out_.erase(out_.begin(), out_.begin() + put);
  }

  void reply(std::uint16_t id, link::Bytes payload, msp::Version version,
             msp::Direction direction = msp::Direction::kFromController) {
    std::array<std::uint8_t, 600> room{};
    const std::size_t size = msp::encode_frame({id, payload, direction, version}, room);
    out_.insert(out_.end(), room.begin(), room.begin() + static_cast<std::ptrdiff_t>(size));
  }
  void answer(const msp::Frame& frame) {
    if (frame.direction != msp::Direction::kToController || silent_) return;
    if (frame.id == msp::kSetRawRc) {
      take_sticks(frame.payload);
      if (acknowledges_) reply(frame.id, {}, frame.version);
      return;
    }
    for (; strange_ > 0; --strange_) reply(99, {}, frame.version);
    if (frame.id == msp::kMultiple) {
      std::vector<std::uint8_t> all;
      for (const std::uint8_t id : frame.payload) {
        const std::vector<std::uint8_t> one = payload_of(id).value_or(std::vector<std::uint8_t>{});
        all.push_back(static_cast<std::uint8_t>(one.size()));
        all.insert(all.end(), one.begin(), one.end());
      }
      return reply(frame.id, all, frame.version);
    }
    if (const auto payload = payload_of(frame.id)) return reply(frame.id, *payload, frame.version);
    reply(frame.id, {}, frame.version, msp::Direction::kRefused);
  }

  template <class Message>
  static std::vector<std::uint8_t> bytes_of(const Message& message) {
    std::vector<std::uint8_t> bytes(link::sizes_of<Message>().all());
    link::ByteWriter out{bytes};
    link::encode(message, out);
    bytes.resize(link::sizes_of<Message>().least());  // this version has nothing that came later
    return bytes;
  }
  std::optional<std::vector<std::uint8_t>> payload_of(std::uint16_t id) {
    using Data = std::vector<std::uint8_t>;
    switch (id) {
      case 4:
        return Data{'H', '7', '4', '3', 0, 0, 0, 0};
      case msp::ApiVersion::kId:
        return bytes_of(msp::ApiVersion{0, 1, 45});
      case msp::FcVariant::kId:
        return bytes_of(msp::FcVariant{{'B', 'T', 'F', 'L'}});
      case msp::FcVersion::kId:
        return bytes_of(msp::FcVersion{4, 4, 3});
      case msp::RcTuning::kId:
        return bytes_of(constants_.tuning);
      case msp::RcDeadband::kId:
        return bytes_of(constants_.deadband);
      case msp::RxConfig::kId:
        return bytes_of(constants_.receiver);
      case msp::RxMap::kId:
        return bytes_of(constants_.map);
      case msp::kBoxIds:
        return Data{0, 1, 27, 50};
      case msp::
          kModeRanges:  // ARM on AUX1, ANGLE on AUX2, override on AUX5, each from 1700 to 2100 µs
        return Data{0, 0, 32, 48, 1, 1, 32, 48, 50, 4, 32, 48};
      case msp::kStatus:
        return status();
      case msp::kRc:
        return rc();
      case msp::RawImu::kId:
        return bytes_of(frozen_ ? imu_ : imu_ = raw_imu());
      case msp::Attitude::kId:
        return bytes_of(attitude());
      case msp::Analog::kId:
        return bytes_of(msp::Analog{.coarse_voltage = static_cast<std::uint8_t>(10 * battery_v_),
                                    .voltage = static_cast<std::uint16_t>(100 * battery_v_)});
      case msp::Altitude::kId:
        return bytes_of(msp::Altitude{static_cast<std::int32_t>(-100 * z_) - 300,
                                      0});  // metres off, as while propellers turn
      default:
        return std::nullopt;
    }
  }
  std::vector<std::uint8_t> status() const {
    std::array<std::uint8_t, 32> room{};
    link::ByteWriter out{room};
    out.put<std::uint16_t>(125), out.put(bus_errors_),
        out.put<std::uint16_t>(no_accel_ ? 0b100010 : 0b100011);
    out.put<std::uint32_t>((armed_ ? 1u : 0u) | (override_ ? 8u : 0u));
    out.put<std::uint8_t>(0), out.put<std::uint16_t>(20), out.put<std::uint16_t>(0);
    out.put<std::uint8_t>(0), out.put<std::uint8_t>(25), out.put<std::uint32_t>(0);
    return {out.written().begin(), out.written().end()};
  }
  std::vector<std::uint8_t> rc() const {
    std::array<std::uint8_t, 64> room{};
    link::ByteWriter out{room};
    const msp::Sticks sticks = obeyed();
    for (const std::uint16_t channel : {sticks.roll, sticks.pitch, sticks.yaw, sticks.throttle})
      out.put(channel);
    for (const bool on : {armed_, false, false, false, override_})
      out.put<std::uint16_t>(on ? 1900 : 1100);
    return {out.written().begin(), out.written().end()};
  }
  void take_sticks(link::Bytes payload) {
    link::ByteReader in{payload};
    const auto channels = in.take_array<std::uint16_t, 4>();
    if (!in.complete()) return;
    const bool kept = sticks_frozen_ && override_ && sent_sticks_.roll != msp::kNeutral.roll;
    if (!kept)
      sent_sticks_ = {
          .roll = channels[0], .pitch = channels[1], .yaw = channels[3], .throttle = channels[2]};
    if (channels_swapped_) std::swap(sent_sticks_.yaw, sent_sticks_.throttle);
    sticks_at_ = seconds();
    ++frames_;
    write_log("frame");
  }
  /// The sticks that it flies by: the radio's are at rest.
  [[nodiscard]] msp::Sticks obeyed() const {
    const bool old = seconds() - sticks_at_ > 0.3;
    if (!(override_ || (override_stuck_ && overridden_)) || frames_ == 0 || deaf_)
      return msp::kNeutral;
    if (old && fails_safe_) return {1500, 1500, 1500, 1200};
    if (old && forgets_) return msp::kNeutral;
    msp::Sticks sticks = sent_sticks_;
    if (!yaws_) sticks.yaw = msp::kNeutral.yaw;
    return sticks;
  }
  msp::RawImu raw_imu() {
    const Eigen::Vector3d f_B =
        rotation_EB(q_).inverse() * (accel_E_ - Eigen::Vector3d(0, 0, kGravity));
    const auto counts = [this](double value, double scale, double noise) {
      return static_cast<std::int16_t>(
          std::lround(value * scale + noise * rng_.uniform(-1.7, 1.7)));
    };
    const double a = constants_.imu.accel_counts_per_g / kGravity,
                 g = constants_.imu.gyro_counts_per_deg_per_s / kDegree;
    msp::RawImu raw;
    raw.accel = {counts(f_B.x(), a, 4), counts(-f_B.y(), a, 4), counts(-f_B.z(), a, 4)};
    raw.gyro = {counts(rates_B_.x(), g, 3), counts(-rates_B_.y(), g, 3),
                counts(-rates_B_.z(), g, 3)};
    if (swapped_) std::swap(raw.gyro[0], raw.gyro[1]);
    if (inverted_) raw.gyro[1] = static_cast<std::int16_t>(-raw.gyro[1]);
    if (saturated_) raw.gyro[2] = 32767;
    for (std::int16_t& count : raw.gyro)
      count = saturated_ ? count : static_cast<std::int16_t>(gyro_part_ * count);
    if (no_accel_) raw.accel = {0, 0, 0};
    return raw;
  }
  [[nodiscard]] msp::Attitude attitude() const {
    const gatefly::Attitude is = gatefly::attitude_of(rotation_EB(q_));
    const double yaw = is.yaw / kDegree;
    return {static_cast<std::int16_t>(std::lround(10 * is.roll / kDegree)),
            static_cast<std::int16_t>(std::lround(-10 * is.pitch / kDegree)),
            static_cast<std::int16_t>(std::lround(yaw < 0 ? yaw + 360 : yaw))};
  }

  /// Rates and thrust follow the sticks with a lag of 40 ms, air drags by 0.3 a second, the floor is at 0.
  virtual void move(double dt) {
    const msp::Sticks sticks = armed_ ? obeyed() : msp::kNeutral;
    const bool held = settings_.start_height > 0 && !override_ && !released_;
    released_ = released_ || (armed_ && override_);
    const auto rates =
        *msp::RateProfile::from(constants_.tuning, constants_.deadband, constants_.receiver);
    const auto curve = *msp::ThrottleCurve::from(constants_.tuning, constants_.receiver);
    const double part = dt / 0.04;
    const double throttle = curve.throttle(sticks.throttle),
                 hover = curve.throttle(constants_.hover_stick);
    const double wanted = armed_
                              ? kGravity * (1 + settings_.hover_error) *
                                    std::pow(std::max(throttle, 0.0) / hover, constants_.exponent)
                              : 0.0;
    thrust_ += part * (wanted - thrust_);
    rates_B_ += part * (rates.rates(sticks) - rates_B_);
    accel_E_ = rotation_EB(q_) * Eigen::Vector3d(0, 0, -thrust_) + Eigen::Vector3d(0, 0, kGravity) -
               0.3 * v_E_;
    const bool on_floor = z_ >= 0 && accel_E_.z() >= 0;
    if (const double since = seconds() - turned_from_; since < 2.0) {
      accel_E_.setZero(), rates_B_.setZero();
      rates_B_[turn_axis_] = (since < 1.0 ? 90 : -90) * kDegree;
      q_ = integrated(q_, rates_B_, dt);
      return;
    }
    if (held || on_floor) {
      accel_E_.setZero(), v_E_.setZero(), rates_B_.setZero();
      const gatefly::Attitude level{0, 0, gatefly::attitude_of(rotation_EB(q_)).yaw};
      q_ = quaternion_of(level);
      return;
    }
    q_ = integrated(q_, rates_B_, dt);
    v_E_ += dt * accel_E_;
    x_ += dt * v_E_.x(), y_ += dt * v_E_.y(), z_ = std::min(0.0, z_ + dt * v_E_.z());
    if (z_ >= 0 && !touched_) touched_ = true, write_log("touch");
    if (z_ < -0.05) touched_ = false;
  }
  void write_log(const char* what) {
    if (!log_.is_open()) return;
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(),
                  "%.4f,%s,%d,%d,%d,%d,%d,%d,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f\n", seconds(), what,
                  sent_sticks_.roll, sent_sticks_.pitch, sent_sticks_.throttle, sent_sticks_.yaw,
                  armed_, override_, x_, y_, z_, v_E_.x(), v_E_.y(), v_E_.z());
    log_ << line.data();
  }

  mutable std::mutex mutex_;
  FakeSettings settings_;
  FakeConstants constants_;
  Clock::time_point start_;
  std::ofstream log_;
  int listener_ = -1, client_ = -1, port_ = 0, frames_ = 0, strange_ = 0;
  msp::Stream stream_;
  std::deque<std::uint8_t> out_;
  double received_ = 0, sent_ = 0, last_ = 0, logged_ = 0, override_at_ = 0, battery_v_ = 24.0;
  bool marked_ = false, armed_ = false, override_ = false, frozen_ = false, silent_ = false,
       released_ = false, touched_ = true;
  msp::Sticks sent_sticks_{0, 0, 0, 0};
  msp::RawImu imu_;
  bool overridden_ = false, deaf_ = false, yaws_ = true, channels_swapped_ = false,
       sticks_frozen_ = false, override_stuck_ = false, acknowledges_ = true, forgets_ = false,
       fails_safe_ = false;
  double sticks_at_ = 0, late_until_ = 0, late_at_ = 0;
  bool swapped_ = false, inverted_ = false, no_accel_ = false, saturated_ = false;
  std::uint16_t bus_errors_ = 0;
  double gyro_part_ = 1.0, turned_from_ = -10.0;
  int turn_axis_ = 0;
  Rng rng_{1};
  Quaternion q_;
  Eigen::Vector3d v_E_ = Eigen::Vector3d::Zero(), rates_B_ = Eigen::Vector3d::Zero(),
                  accel_E_ = Eigen::Vector3d::Zero();
  double x_ = 0, y_ = 0, z_ = 0, thrust_ = 0;
};

}  // namespace gatefly::test
