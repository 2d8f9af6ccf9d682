// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/link/bytes.hpp"
#include "gatefly/link/msp_axes.hpp"
#include "gatefly/sensing/imu.hpp"

/// The datagrams of Betaflight's simulator target: what it hears of physics (9003) and of a receiver (9004),
/// and what it tells motors (9002, 9001).
namespace gatefly::betaflight_sitl {

using link::Bytes;

/// The drone's true state, in our frames.
struct State {
  std::chrono::nanoseconds time{0};
  gatefly::Imu imu{};
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero(), v_E = Eigen::Vector3d::Zero();
  gatefly::Attitude attitude{};
};

/// Latitude and longitude of E's origin, for the simulated satellite receiver; any place will do.
struct Origin {
  double latitude_deg = 52.0, longitude_deg = 4.37;
  double pressure_pa = 101325.0;
};

/// Version of the simulator: they read the yaw's gyro with opposite signs.
enum class Release {
  k4_5,   ///< And 2025.12.
  k2026,  ///< From 2026.6 on.
};

inline constexpr std::size_t kStateSize = 18 * 8;
/// 18 doubles: time [s]; gyro p, q, **−r** (of 4.5: r) [rad/s]; accelerometer **−x**, y, z [m/s²] of the specific
/// force; attitude w, x, y, z before two turns that its reader makes; velocity east, north, up [m/s];
/// longitude, latitude [°], height [m]; pressure [Pa].
[[nodiscard]] std::array<std::uint8_t, kStateSize> encode_state(const State& state,
                                                                Release release = Release::k2026,
                                                                const Origin& origin = {});

/// Motors 0 … 1, four floats: rear right, front right, rear left, front left; of 4.5 as Gazebo counts them: front right, rear left,
/// front left, rear right. raw_servos_in() has one order always.
[[nodiscard]] std::optional<std::array<float, 4>> motors_in(Bytes datagram);

/// Pulses as the outputs have them [µs]: rear right, front right, rear left, front left. u16 number of motors, two bytes of nothing, 16 floats.
struct RawServos {
  std::uint16_t motors = 0;
  std::array<float, 16> pulse_us{};
};
[[nodiscard]] std::optional<RawServos> raw_servos_in(Bytes datagram);

inline constexpr std::size_t kReceiverSize = 8 + 16 * 2;
/// A receiver's sticks and switches: time [s] and 16 pulses: roll, pitch, throttle, yaw, AUX1 … AUX12 [µs].
[[nodiscard]] std::array<std::uint8_t, kReceiverSize> encode_receiver(
    std::chrono::nanoseconds time, const msp::Sticks& sticks,
    const std::array<std::uint16_t, 12>& aux);

}  // namespace gatefly::betaflight_sitl
