// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "gatefly/link/betaflight_sitl.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::link_sim {

struct LinkSimParams;

/// A flight controller, a program of its own or ours: what it tells its motors, what it is told of its sensors and by its radio.
class Controller {
 public:
  virtual ~Controller() = default;
  /// Takes what has come until `now` [s].
  virtual void listen(double now) = 0;
  /// Tells what its sensors feel; after every step of the physics.
  virtual void feel(const betaflight_sitl::State& told, const sim::BodyState& body) = 0;
  virtual void hear_radio(std::chrono::nanoseconds time, const msp::Sticks& sticks,
                          const std::array<std::uint16_t, 12>& switches) = 0;

  /// 0 … 1: front left, front right, rear right, rear left.
  [[nodiscard]] const std::array<double, 4>& motors() const { return motors_; }
  /// The motors turn: it has armed.
  [[nodiscard]] virtual bool turn() const;
  /// A program talks to it, of one that is talked to without a serial line.
  [[nodiscard]] virtual bool called() const { return false; }
  /// Age of the last set point of that program [s].
  [[nodiscard]] virtual double held_for() const { return 0.0; }
  /// That program is cut off.
  virtual void cut() {}
  /// It has told its motors something.
  [[nodiscard]] bool ever() const { return last_.has_value(); }

 protected:
  /// Pulses [µs] at `now`, each from the place that `theirs` names for ours.
  template <class Pulse>
  void told(std::span<const Pulse> pulses, const std::array<std::size_t, 4>& theirs, double now) {
    for (std::size_t i = 0; i < 4; ++i) motors_[i] = part_of(double(pulses[theirs[i]]));
    last_ = now;
  }
  /// A speed controller stops its motor when nothing comes.
  void stop_if_silent(double now);

 private:
  [[nodiscard]] static double part_of(double pulse_us);

  std::array<double, 4> motors_{};
  std::optional<double> last_;
};

/// The one that the parameters name, in a seed's drone. @throws std::runtime_error one line: a port is taken.
[[nodiscard]] std::unique_ptr<Controller> controller_of(const LinkSimParams& params,
                                                        const world::SimConfig& config);

}  // namespace gatefly::link_sim
