// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/controller.hpp"

#include <algorithm>
#include <chrono>

#include "gatefly/link/ardupilot_json.hpp"
#include "gatefly/link/betaflight_sitl.hpp"
#include "gatefly/simulated_race/link_sim/datagrams.hpp"
#include "gatefly/simulated_race/link_sim/link_sim.hpp"
#include "gatefly/simulated_race/link_sim/px4_end.hpp"
#include "gatefly/simulated_race/link_sim/ts002_end.hpp"

namespace gatefly::link_sim {
namespace {

using namespace std::chrono_literals;

constexpr double kSilence = 0.5;  ///< [s]

/// Betaflight's simulator target.
///
/// It sets the rate of its clock from the last two stamps, unless they are 20 ms apart or more. Two packets that arrive at once
/// made it run hundreds of times too fast, so that it missed its radio. Stamps 50 ms apart leave its clock alone.
class BetaflightEnd : public Controller {
 public:
  BetaflightEnd(const Ports& ports, betaflight_sitl::Release release)
      : heard_{Datagrams::at(ports.servos)},
        sensors_{Datagrams::to(ports.state)},
        receiver_{Datagrams::to(ports.radio)},
        release_{release} {}

  void listen(double now) override {
    std::array<std::uint8_t, 256> room{};
    while (const auto bytes = heard_.receive(room)) {
      const auto servos = betaflight_sitl::raw_servos_in(*bytes);
      // Betaflight counts rear right, front right, rear left, front left.
      if (servos && servos->motors >= 4)
        told(std::span<const float>{servos->pulse_us}, {3, 1, 0, 2}, now);
    }
    stop_if_silent(now);
  }
  void feel(const betaflight_sitl::State& told, const sim::BodyState&) override {
    betaflight_sitl::State state = told;
    state.time = stamp_ += kBetweenStamps;
    sensors_.send(betaflight_sitl::encode_state(state, release_));
  }
  void hear_radio(std::chrono::nanoseconds time, const msp::Sticks& sticks,
                  const std::array<std::uint16_t, 12>& switches) override {
    receiver_.send(betaflight_sitl::encode_receiver(time, sticks, switches));
  }

 private:
  static constexpr auto kBetweenStamps = 50ms;

  Datagrams heard_, sensors_, receiver_;
  betaflight_sitl::Release release_;
  std::chrono::nanoseconds stamp_{};
};

/// ArduCopter with its JSON interface: it asks for each of its steps with what its motors are to do, and waits for the answer. Its clock
/// is what we tell it, so it keeps our time however long a step of its own takes.
class ArduPilotEnd : public Controller {
 public:
  explicit ArduPilotEnd(const Ports& ports)
      : line_{Datagrams::at(ports.servos)}, receiver_{Datagrams::to(ports.radio)} {}

  void listen(double now) override {
    std::array<std::uint8_t, 256> room{};
    while (const auto bytes = line_.receive(room)) {
      const auto servos = ardupilot::servos_in(*bytes);
      if (!servos) continue;
      asked_ = true;
      // ArduPilot counts front right, rear left, front left, rear right.
      told(std::span<const std::uint16_t>{servos->pulse_us}, {2, 0, 3, 1}, now);
    }
    stop_if_silent(now);
  }
  /// The mean since the last answer: between two of them its sensors felt all of it.
  void feel(const betaflight_sitl::State& is, const sim::BodyState& body) override {
    gyro_ += is.imu.gyro_B, accel_ += is.imu.accel_B, ++felt_;
    if (!asked_) return;
    std::array<char, ardupilot::kLongestLine> line{};
    const std::size_t size =
        ardupilot::encode_state({.time = is.time,
                                 .imu = {gyro_ / felt_, accel_ / felt_},
                                 .p_EB = is.p_EB,
                                 .v_E = is.v_E,
                                 .attitude = quaternion_of(attitude_of({sim::R_EB_of(body.q_EB)}))},
                                line);
    line_.answer({reinterpret_cast<const std::uint8_t*>(line.data()), size});
    gyro_.setZero(), accel_.setZero(), felt_ = 0, asked_ = false;
  }
  void hear_radio(std::chrono::nanoseconds, const msp::Sticks& sticks,
                  const std::array<std::uint16_t, 12>& switches) override {
    receiver_.send(ardupilot::encode_receiver(sticks, switches));
  }

 private:
  Datagrams line_, receiver_;
  Eigen::Vector3d gyro_ = Eigen::Vector3d::Zero(), accel_ = Eigen::Vector3d::Zero();
  int felt_ = 0;
  bool asked_ = false;
};

}  // namespace

bool Controller::turn() const {
  return std::all_of(motors_.begin(), motors_.end(), [](double part) { return part > 0.0; });
}

void Controller::stop_if_silent(double now) {
  if (last_ && now - *last_ > kSilence) motors_ = {};
}

double Controller::part_of(double pulse_us) {
  return std::clamp(1e-3 * (pulse_us - 1000.0), 0.0, 1.0);
}

std::unique_ptr<Controller> controller_of(const LinkSimParams& params,
                                          const world::SimConfig& config) {
  if (params.autopilot == Autopilot::kTs002)
    return std::make_unique<Ts002End>(Ts002End::Params{.port = params.ports.mavlink,
                                                       .tells_attitude = params.tells_attitude,
                                                       .network = params.network},
                                      config);
  if (params.autopilot == Autopilot::kPx4)
    return std::make_unique<Px4End>(Px4End::Params{.simulator = params.ports.state,
                                                   .companion = params.ports.controller,
                                                   .station = params.ports.radio,
                                                   .port = params.ports.mavlink,
                                                   .network = params.network},
                                    config);
  if (params.autopilot == Autopilot::kArduCopter)
    return std::make_unique<ArduPilotEnd>(params.ports);
  return std::make_unique<BetaflightEnd>(params.ports, params.release);
}

}  // namespace gatefly::link_sim
