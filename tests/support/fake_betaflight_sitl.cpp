// SPDX-License-Identifier: Apache-2.0
// The fake controller behind somebody else's physics, as Betaflight's simulator target is: it feels what datagrams tell it, hears its
// radio by datagrams, holds rates with the autopilot of our own simulator, and tells its motors.
//   fake_betaflight_sitl --state PORT --radio PORT --servos PORT --msp PORT [--log FILE]
//     until its standard input ends
#include <cmath>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include "gatefly/estimation/low_pass.hpp"
#include "gatefly/geometry/rotation_vector.hpp"
#include "gatefly/link/betaflight_sitl.hpp"
#include "gatefly/sim/autopilot/autopilot.hpp"
#include "gatefly/simulated_race/link_sim/datagrams.hpp"
#include "gatefly/simulated_race/race_maker.hpp"

#include "support/fake_betaflight.hpp"

namespace gatefly::test {
namespace {

struct SitlPorts {
  int state = 9003, radio = 9004, servos = 9001;
};

/// The rates and the throttle curve of the AI Grand Prix, which are the simulated autopilot's own.
FakeConstants constants_of(const world::AutopilotTruth& truth) {
  const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(value)); };
  FakeConstants constants;
  constants.tuning = {.roll_rc_rate = byte(truth.rc_rate.x()),
                      .super_rate = {byte(truth.super_rate.x()), byte(truth.super_rate.y()),
                                     byte(truth.super_rate.z())},
                      .throttle_mid = byte(truth.throttle_mid),
                      .throttle_expo = byte(truth.throttle_expo),
                      .yaw_rc_rate = byte(truth.rc_rate.z()),
                      .pitch_rc_rate = byte(truth.rc_rate.y()),
                      .throttle_limit_percent = 100,
                      .rate_limit = {1998, 1998, 1998},
                      .rates_type = 0};
  constants.deadband = {};
  return constants;
}

class FakeSitl : public FakeBetaflight {
 public:
  FakeSitl(const FakeSettings& settings, const SitlPorts& ports, const world::SimConfig& drone)
      : FakeBetaflight{settings, constants_of(drone.autopilot)},
        state_{link_sim::Datagrams::at(ports.state)},
        radio_{link_sim::Datagrams::at(ports.radio)},
        servos_{link_sim::Datagrams::to(ports.servos)},
        highest_{drone.vehicle.max_speed},
        autopilot_{drone.autopilot, drone.vehicle},
        gyro_filter_{drone.sensors.autopilot_gyro_cutoff, kHz},
        accel_filter_{drone.sensors.autopilot_accel_cutoff, kHz} {}

 private:
  /// Once a millisecond: what has arrived, then the motors.
  void move(double dt) override {
    std::array<std::uint8_t, 512> room{};
    while (const auto bytes = radio_.receive(room)) hear_radio(*bytes);
    bool felt = false;
    while (const auto bytes = state_.receive(room)) felt = feel(*bytes) || felt;
    waited_ += dt;
    if (!felt) return;
    // In a hand it is disarmed and does not stand: its angles follow the gyro, its motors stay off.
    still_for_ = felt_.gyro_B.norm() > 0.15 ? 0.0 : still_for_ + waited_;
    const bool in_hand = !armed_ && still_for_ < 1.0;
    std::array<double, 4> speeds = autopilot_.step({obeyed(), armed_ || in_hand}, felt_, waited_);
    if (in_hand) speeds = {};
    // Its telemetry is filtered: at 50 samples a second the rotors' vibration would be all there is.
    rates_B_ = gyro_filter_.update(felt_.gyro_B);
    yaw_ += rates_B_.z() * waited_;
    waited_ = 0.0;
    const Eigen::Vector2d angles = autopilot_.angles();
    q_ = quaternion_of(gatefly::Attitude{angles.x(), angles.y(), std::remainder(yaw_, 2 * kPi)});
    accel_E_ =
        rotation_EB(q_) * accel_filter_.update(felt_.accel_B) + Eigen::Vector3d(0, 0, kGravity);
    tell(speeds);
  }
  /// Reads gyro p, q, r, as 4.5 has it, and accelerometer -x, y, z from 18 doubles.
  bool feel(link::Bytes bytes) {
    if (bytes.size() != betaflight_sitl::kStateSize) return false;
    std::array<double, 18> all{};
    std::memcpy(all.data(), bytes.data(), bytes.size());
    felt_ = {{all[1], all[2], all[3]}, {-all[4], all[5], all[6]}};
    if (averaged_ > 0) {
      bias_ += (felt_.accel_B + Eigen::Vector3d(0, 0, kGravity)) / kAveraged;
      if (--averaged_ == 0) std::cout << "calibrated" << std::endl;
    } else {
      felt_.accel_B -= bias_;
    }
    return true;
  }
  void hear_radio(link::Bytes bytes) {
    if (bytes.size() != betaflight_sitl::kReceiverSize) return;
    std::array<std::uint16_t, 16> channels{};
    std::memcpy(channels.data(), bytes.data() + sizeof(double), sizeof channels);
    constexpr int kOn = 1700;
    armed_ = channels[4] > kOn;
    // Throttle up, yaw left, pitch back: the accelerometer is calibrated.
    const bool asks = !armed_ && channels[2] > 1900 && channels[3] < 1050 && channels[1] < 1050;
    if (asks && !asked_) bias_.setZero(), averaged_ = kAveraged;
    asked_ = asks;
    override_ = channels[8] > kOn;
  }
  void tell(const std::array<double, 4>& speeds) {
    std::array<std::uint8_t, 4 + 16 * 4> room{};
    link::ByteWriter out{room};
    out.put<std::uint16_t>(4), out.put<std::uint16_t>(0);
    // Ours are front left, front right, rear right, rear left.
    constexpr std::array<std::size_t, 4> kOurs{2, 1, 3, 0};
    for (std::size_t i = 0; i < 16; ++i)
      out.put(i < 4 ? static_cast<float>(1000.0 + 1000.0 * speeds[kOurs[i]] / highest_) : 0.0f);
    servos_.send(room);
  }

  link_sim::Datagrams state_, radio_, servos_;
  double highest_, yaw_ = 0.0, waited_ = 0.0, still_for_ = 10.0;
  sim::Autopilot autopilot_;
  Imu felt_;
  static constexpr double kHz = 1000.0;
  static constexpr int kAveraged = 400;
  int averaged_ = 0;  ///< Samples still to come.
  bool asked_ = false;
  Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();
  LowPass gyro_filter_, accel_filter_;
};

int fake_sitl(const std::vector<std::string>& words) {
  FakeSettings settings;
  SitlPorts ports;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    if (words[i] == "--log") settings.log = words[i + 1];
    if (words[i] == "--msp") settings.port = std::stoi(words[i + 1]);
    if (words[i] == "--state") ports.state = std::stoi(words[i + 1]);
    if (words[i] == "--radio") ports.radio = std::stoi(words[i + 1]);
    if (words[i] == "--servos") ports.servos = std::stoi(words[i + 1]);
  }
  settings.baud = 10'000'000;  // link-sim's line is the slow one
  simulated_race::RaceArguments drone_of;
  drone_of.config.configs = {"archer-b2", "betaflight"};
  drone_of.track = "oval";
  const simulated_race::RaceMaker maker(drone_of);
  FakeSitl drone{settings, ports, maker.race(1).config.sim};
  std::cout << "port " << drone.port() << std::endl;
  for (;;) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    std::array<char, 256> room{};
    if (poll(&input, 1, 0) > 0 && read(STDIN_FILENO, room.data(), room.size()) <= 0) return 0;
    drone.serve();
    std::this_thread::sleep_for(std::chrono::microseconds{300});
  }
}

}  // namespace
}  // namespace gatefly::test

int main(int argc, char** argv) try {
  return gatefly::test::fake_sitl({argv + 1, argv + argc});
} catch (const std::exception& error) {
  std::cerr << "fake_betaflight_sitl: " << error.what() << '\n';
  return 2;
}
