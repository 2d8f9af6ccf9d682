// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "gatefly/link/mavlink_telemetry.hpp"

namespace gatefly::guard {

/// Answers of an autopilot that speaks MAVLink about itself; one that did not come is absent. `Parameter` counts those of its parameters
/// that decide what a set point of ours does.
template <class Parameter, std::size_t kCount>
struct AutopilotFacts {
  std::optional<mavlink::Heartbeat> heartbeat;
  std::optional<mavlink::AutopilotVersion> version;
  std::optional<mavlink::SysStatus> sensors;
  std::array<std::optional<float>, kCount> parameters;

  [[nodiscard]] std::optional<float> parameter(Parameter which) const {
    return parameters[static_cast<std::size_t>(which)];
  }
  [[nodiscard]] bool has_all_parameters() const {
    return std::all_of(parameters.begin(), parameters.end(),
                       [](const auto& each) { return each.has_value(); });
  }
  /// One that does not say counts as armed.
  [[nodiscard]] bool armed() const { return !heartbeat || heartbeat->is_armed(); }
  [[nodiscard]] bool is_multicopter() const {
    /// MAV_TYPE of quadrotor, coaxial, hexarotor, octorotor, tricopter, dodecarotor, decarotor.
    constexpr std::array<std::uint8_t, 7> kMulticopters{2, 3, 13, 14, 15, 29, 35};
    return heartbeat && std::find(kMulticopters.begin(), kMulticopters.end(), heartbeat->type) !=
                            kMulticopters.end();
  }
  [[nodiscard]] bool gyro_works() const { return is_present(kGyro) && is_healthy(kGyro); }
  [[nodiscard]] bool accelerometer_works() const {
    return is_present(kAccelerometer) && is_healthy(kAccelerometer);
  }
  [[nodiscard]] bool is_healthy(std::uint32_t sensor) const {
    return sensors && (sensors->onboard_control_sensors_health & sensor) != 0;
  }
  /// Bits of SYS_STATUS.
  static constexpr std::uint32_t kGyro = 1, kAccelerometer = 2;

 private:
  [[nodiscard]] bool is_present(std::uint32_t sensor) const {
    return sensors && (sensors->onboard_control_sensors_present & sensor) != 0;
  }
};

/// Longest time for which an autopilot may go on with our last set point [s]. Our second process takes over within 62 ms, so a second of
/// silence means that both are gone.
inline constexpr float kLongestHold = 1.0f;

}  // namespace gatefly::guard
