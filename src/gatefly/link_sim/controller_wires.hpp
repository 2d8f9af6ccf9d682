// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "gatefly/link/betaflight_sitl.hpp"
#include "gatefly/link_sim/datagrams.hpp"

namespace gatefly::link_sim {

/// The motors as the controller last told them.
class Motors {
 public:
  /// @throws std::runtime_error one line: the port is taken.
  explicit Motors(int port) : heard_{Datagrams::at(port)} {}

  /// Takes what has arrived until `now` [s].
  void listen(double now);
  /// Parts of the highest speed, 0 … 1: front left, front right, rear right, rear left.
  [[nodiscard]] const std::array<double, 4>& now() const { return motors_; }
  [[nodiscard]] bool turn() const;
  /// It has said something to its motors at all.
  [[nodiscard]] bool ever() const { return last_.has_value(); }

 private:
  static constexpr double kSilence = 0.5;  ///< Then a speed controller stops its motor [s].
  Datagrams heard_;
  std::array<double, 4> motors_{};
  std::optional<double> last_;
};

/// Tells the controller what its sensors feel.
///
/// Betaflight sets the rate of its clock from the last two stamps, unless they are 20 ms apart or more. Two packets that arrive at once
/// made it run hundreds of times too fast, so that it missed its radio. Stamps 50 ms apart leave its clock alone.
class Sensors {
 public:
  Sensors(int port, betaflight_sitl::Release release)
      : to_{Datagrams::to(port)}, release_{release} {}

  void send(betaflight_sitl::State state) {
    state.time = stamp_ += kBetweenStamps;
    to_.send(betaflight_sitl::encode_state(state, release_));
  }

 private:
  static constexpr auto kBetweenStamps = std::chrono::milliseconds{50};

  Datagrams to_;
  betaflight_sitl::Release release_;
  std::chrono::nanoseconds stamp_{};
};

}  // namespace gatefly::link_sim
