// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/link/msp_messages.hpp"
#include "gatefly/sensing/imu.hpp"

// Betaflight's axes and units to ours and back: here, and nowhere else. Its body frame is front,
// left, up where ours is front, right, down; so pitch, and the gyro's yaw, have the other sign, but
// not the attitude's yaw, which is a compass heading.

namespace gatefly::msp {

/// Size of a count of MSP_RAW_IMU. It differs between controllers: to be read from the drone at rest and turned by hand.
struct ImuScale {
  double gyro_counts_per_deg_per_s = 16.384;  ///< 2000 °/s over 15 bits.
  double accel_counts_per_g = 512.0;          ///< Betaflight's simulator: 256.
};

/// In our body frame, SI.
[[nodiscard]] gatefly::Imu imu_of(const RawImu& raw, const ImuScale& scale);

/// In our angles [rad]; its yaw is as coarse as a degree.
[[nodiscard]] gatefly::Attitude attitude_of(const Attitude& attitude);

/// Positions of the four sticks [µs], 1000 … 2000.
struct Sticks {
  std::uint16_t roll = 1500;      ///< More: right side down.
  std::uint16_t pitch = 1500;     ///< More: nose **down**.
  std::uint16_t yaw = 1500;       ///< More: nose right.
  std::uint16_t throttle = 1000;  ///< More: up.
  friend bool operator==(const Sticks&, const Sticks&) = default;
};

/// Sticks at rest: nothing turns, no thrust.
inline constexpr Sticks kNeutral{};

/// Our rates about front, right, down in the order and with the signs of the sticks: roll, pitch, yaw [rad/s].
[[nodiscard]] Eigen::Vector3d stick_rates(const Eigen::Vector3d& rates_B);
/// And back.
[[nodiscard]] Eigen::Vector3d body_rates(const Eigen::Vector3d& stick_rates);

/// In which place of MSP_SET_RAW_RC the sticks go. Its usual order is roll, pitch, **throttle, yaw**, not that of MSP_RC.
class ChannelOrder {
 public:
  ChannelOrder() = default;
  /// nullopt when the map does not put the four sticks into the first four places, each into one.
  [[nodiscard]] static std::optional<ChannelOrder> from(const RxMap& map);

  /// The payload of MSP_SET_RAW_RC, four channels.
  [[nodiscard]] std::array<std::uint8_t, 8> set_raw_rc(const Sticks& sticks) const;

 private:
  std::array<std::uint8_t, 4> place_{0, 1, 3, 2};  ///< Channel index of roll, pitch, yaw, throttle.
};

/// The sticks that a controller flies by, from MSP_RC; nullopt when there are fewer than four.
[[nodiscard]] std::optional<Sticks> sticks_in_rc(std::span<const std::uint16_t> channels);

}  // namespace gatefly::msp
