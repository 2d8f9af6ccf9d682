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

/// Both sides of ArduPilot's simulator ("JSON", UDP 9002): servo packets to a physics model, its state back.
namespace gatefly::ardupilot {

using link::Bytes;

/// Its motors' pulses. u16 magic, u16 steps a second, u32 frame, u16 pulses: 16, or 32 with the other magic.
struct Servos {
  std::uint16_t steps_per_second = 0;
  std::uint32_t frame = 0;  ///< The same again: it is sent once more, and no time passes.
  std::array<std::uint16_t, 32> pulse_us{};
  std::size_t channels = 0;  ///< 16 or 32.
};

/// nullopt when it is no such packet, to the byte.
[[nodiscard]] std::optional<Servos> servos_in(Bytes datagram);

/// The drone's true state, in our frames.
struct State {
  std::chrono::nanoseconds time{0};
  gatefly::Imu imu{};
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero(), v_E = Eigen::Vector3d::Zero();
  Quaternion attitude{};
  std::optional<double> range_down = std::nullopt;  ///< Distance of the range finder, `rng_1` [m].
};

/// Enough for every state.
inline constexpr std::size_t kLongestLine = 1024;

/// Writes the line that answers; returns its length, 0 when it does not fit or something is no number: its
/// reader takes anything for a number.
[[nodiscard]] std::size_t encode_state(const State& state, std::span<char> out);

/// A receiver's 16 pulses [µs], which it hears at UDP 5501: roll, pitch, throttle, yaw, AUX1 … AUX12.
[[nodiscard]] std::array<std::uint8_t, 32> encode_receiver(
    const msp::Sticks& sticks, const std::array<std::uint16_t, 12>& aux);

}  // namespace gatefly::ardupilot
