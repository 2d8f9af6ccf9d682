// SPDX-License-Identifier: Apache-2.0
// The fake ArduCopter behind somebody else's physics, as ArduCopter's simulator with its JSON interface is: it asks for each step with
// what its motors do, hears its radio by datagrams, and holds rates with the autopilot of our own simulator.
//   fake_arducopter_sitl --servos PORT --radio PORT --port TCP_PORT [--log FILE]
//     until its standard input ends
#include <cmath>
#include <cstring>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/estimation/low_pass.hpp"
#include "gatefly/sim/autopilot/autopilot.hpp"
#include "gatefly/simulated_race/link_sim/datagrams.hpp"
#include "gatefly/simulated_race/race_maker.hpp"

#include "support/fake_arducopter.hpp"

namespace gatefly::test {
namespace {

class FakeArduSitl : public FakeArduCopter {
 public:
  FakeArduSitl(const FakeArduSettings& settings, int servos, int radio,
               const world::SimConfig& drone)
      : FakeArduCopter{settings},
        physics_{link_sim::Datagrams::to(servos)},
        radio_{link_sim::Datagrams::at(radio)},
        highest_{drone.vehicle.max_speed},
        curves_{drone.autopilot},
        autopilot_{drone.autopilot, drone.vehicle} {}

 private:
  void move(double dt) override {
    std::array<std::uint8_t, 2048> room{};
    while (const auto bytes = radio_.receive(room)) hear_radio(*bytes);
    bool felt = false;
    while (const auto bytes = physics_.receive(room)) felt = feel(*bytes) || felt;
    waited_ += dt;
    // A question that has met nobody is asked again.
    if (!felt && waited_ < 1.0) return;
    if (!felt) return ask();
    const Obeyed wanted = obeyed();
    const double speed = highest_ * std::sqrt(std::clamp(wanted.thrust, 0.0, 1.0));
    msp::Sticks sticks = curves_.rates.sticks(wanted.rates_B);
    sticks.throttle =
        static_cast<std::uint16_t>(curves_.throttle.stick(sim::throttle_of(speed, highest_)));
    speeds_ = autopilot_.step({sticks, armed_}, felt_now_, waited_);
    yaw_ += felt_now_.gyro_B.z() * waited_;
    const Eigen::Vector2d angles = autopilot_.angles();
    body_.q =
        quaternion_of(gatefly::Attitude{angles.x(), angles.y(), std::remainder(yaw_, 2 * kPi)});
    gyro_ = gyro_filter_.update(felt_now_.gyro_B);
    force_ = accel_filter_.update(felt_now_.accel_B);
    waited_ = 0.0;
    ask();
  }
  bool feel(link::Bytes bytes) {
    const auto told = nlohmann::json::parse(bytes.begin(), bytes.end(), nullptr, false);
    if (told.is_discarded()) return false;
    const auto vector = [&](const nlohmann::json& values) {
      return Eigen::Vector3d{values.at(0).get<double>(), values.at(1).get<double>(),
                             values.at(2).get<double>()};
    };
    felt_now_ = {vector(told.at("imu").at("gyro")), vector(told.at("imu").at("accel_body"))};
    return true;
  }
  void hear_radio(link::Bytes bytes) {
    if (bytes.size() != 32) return;
    std::array<std::uint16_t, 16> channels{};
    std::memcpy(channels.data(), bytes.data(), sizeof channels);
    constexpr int kOn = 1700;
    armed_ = channels[4] > kOn;
    const bool guided = channels[8] > kOn;
    if (guided && mode_ == 0) guided_at_ = seconds();
    mode_ = guided ? mavlink::kGuidedNoGps : 0;
  }
  void ask() {
    std::array<std::uint8_t, 8 + 32> room{};
    link::ByteWriter out{room};
    out.put<std::uint16_t>(18458), out.put<std::uint16_t>(400), out.put(++frame_);
    // Ours are front left, front right, rear right, rear left.
    constexpr std::array<std::size_t, 4> kOurs{1, 3, 0, 2};
    for (std::size_t i = 0; i < 16; ++i)
      out.put(static_cast<std::uint16_t>(
          i < 4 && armed_ ? std::lround(1000.0 + 1000.0 * speeds_[kOurs[i]] / highest_) : 1000));
    physics_.send(room);
    waited_ = 0.0;
  }
  [[nodiscard]] Eigen::Vector3d gyro() const override { return gyro_; }
  [[nodiscard]] Eigen::Vector3d force() const override { return force_; }

  link_sim::Datagrams physics_, radio_;
  double highest_, yaw_ = 0.0, waited_ = 1.0;
  sim::StickCurves curves_;
  sim::Autopilot autopilot_;
  std::array<double, 4> speeds_{};
  Imu felt_now_{Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, -kGravity)};
  Eigen::Vector3d gyro_ = Eigen::Vector3d::Zero(), force_{0, 0, -kGravity};
  std::uint32_t frame_ = 0;
  /// Its telemetry is filtered, as INS_GYRO_FILTER and INS_ACCEL_FILTER do it.
  static constexpr double kHz = 500.0;
  LowPass gyro_filter_{20.0, kHz}, accel_filter_{10.0, kHz};
};

int fake_sitl(const std::vector<std::string>& words) {
  FakeArduSettings settings;
  int servos = 9002, radio = 5501;
  settings.port = 5760;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    if (words[i] == "--log") settings.log = words[i + 1];
    if (words[i] == "--port") settings.port = std::stoi(words[i + 1]);
    if (words[i] == "--radio") radio = std::stoi(words[i + 1]);
    if (words[i] == "--servos") servos = std::stoi(words[i + 1]);
    if (words[i] == "--hover") settings.hover = std::stod(words[i + 1]);
  }
  simulated_race::RaceArguments drone_of;
  drone_of.config.configs = {"archer-b2", "arducopter"};
  drone_of.track = "oval";
  const simulated_race::RaceMaker maker(drone_of);
  FakeArduSitl drone{settings, servos, radio, maker.race(1).config.sim};
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
  std::cerr << "fake_arducopter_sitl: " << error.what() << '\n';
  return 2;
}
