// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include <Eigen/Core>

#include "gatefly/link/bytes.hpp"
#include "gatefly/link/msp_axes.hpp"
#include "gatefly/live/controller_state.hpp"

// Differences between flight controllers: the bytes of questions, the bytes of commands. No port, no thread, no clock.

namespace gatefly::live {

/// Command for one period, in our axes.
struct Demand {
  bool rests = true;                                  ///< On the floor: no turn, no thrust.
  Eigen::Vector3d rates_B = Eigen::Vector3d::Zero();  ///< About front, right, down [rad/s].
  double thrust = 0.0;                                ///< Specific [m/s²].
};

/// Asks a controller, and understands what it tells. It has no function that flies.
class Listener {
 public:
  virtual ~Listener() = default;
  /// The bytes that are due to be sent, valid until the next call; empty when none are.
  [[nodiscard]] virtual link::Bytes request(std::chrono::nanoseconds now) = 0;
  /// Bytes that arrived. @return whether an IMU sample was among them.
  virtual bool take(link::Bytes bytes, std::chrono::nanoseconds now) = 0;
  [[nodiscard]] virtual const ControllerState& state() const = 0;
};

/// Flies a controller.
class Speaker {
 public:
  virtual ~Speaker() = default;
  /// The bytes of a set point, valid until the next call; they will be sent.
  [[nodiscard]] virtual link::Bytes set_point(const Demand& demand,
                                              std::chrono::nanoseconds now) = 0;
  /// Expected ControllerState::sticks once the controller obeys the command.
  [[nodiscard]] virtual msp::Sticks sticks(const Demand& demand) const = 0;
};

}  // namespace gatefly::live
