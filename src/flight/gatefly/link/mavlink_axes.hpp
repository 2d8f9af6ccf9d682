// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/link/mavlink_commands.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"
#include "gatefly/sensing/imu.hpp"

// MAVLink's axes are ours: earth north, east, down; body front, right, down; quaternions w, x, y, z, body to
// earth. What differs are units, and what is left out: here, and nowhere else.

namespace gatefly::mavlink {

[[nodiscard]] gatefly::Imu imu_of(const HighresImu& imu);
/// From mg and mrad/s.
[[nodiscard]] gatefly::Imu imu_of(const ScaledImu& imu);
/// ArduPilot's RAW_IMU has mg and mrad/s, too; others have counts, whose size nobody tells.
[[nodiscard]] gatefly::Imu ardupilot_imu_of(const RawImu& imu);
[[nodiscard]] gatefly::Attitude attitude_of(const Attitude& attitude);
[[nodiscard]] gatefly::Attitude attitude_of(const AttitudeQuaternion& attitude);

/// Position and velocity in E [m, m/s].
struct Place {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero(), v_E = Eigen::Vector3d::Zero();
};
[[nodiscard]] Place place_of(const LocalPositionNed& place);

/// ArduCopter's custom_mode in which it flies by set points of attitude or rates without knowing where it is.
inline constexpr std::uint32_t kGuidedNoGps = 20;
/// PX4's main mode in which it flies by set points, bits 16 to 23 of its custom_mode.
inline constexpr std::uint32_t kPx4Offboard = 6;
[[nodiscard]] constexpr bool is_offboard(std::uint32_t custom_mode) {
  return ((custom_mode >> 16) & 0xFF) == kPx4Offboard;
}

/// A parameter's value as PX4 tells it: those of whole numbers are the bits of an int32. ArduPilot tells all as numbers.
[[nodiscard]] float px4_value_of(const ParamValue& value);

/// Addressee of a command.
struct Target {
  std::uint8_t system = 1, component = 1;
};

/// Attitude and thrust; `thrust` is a part of the most there is, 0 … 1, and so limited.
[[nodiscard]] SetAttitudeTarget attitude_target(const Target& target,
                                                const gatefly::Attitude& attitude, double thrust,
                                                std::chrono::milliseconds since_start);
/// Rates about front, right, down [rad/s] and thrust.
[[nodiscard]] SetAttitudeTarget rate_target(const Target& target, const Eigen::Vector3d& rates_B,
                                            double thrust, std::chrono::milliseconds since_start);
/// A velocity in E [m/s] and a heading [rad].
[[nodiscard]] SetPositionTargetLocalNed velocity_target(const Target& target,
                                                        const Eigen::Vector3d& v_E, double yaw,
                                                        std::chrono::milliseconds since_start);

/// The question that asks for the peer's clock.
[[nodiscard]] Timesync clock_question(std::chrono::nanoseconds now);
/// The answer to the peer's question; nullopt when it is none.
[[nodiscard]] std::optional<Timesync> clock_answer(const Timesync& question,
                                                   std::chrono::nanoseconds now);

/// The peer's clock less ours, from an answer to our question.
struct ClockOffset {
  std::chrono::nanoseconds offset{0};
  std::chrono::nanoseconds round_trip{0};  ///< The offset is within half of it.
};
/// nullopt when it is no answer, or one to a question of the future.
[[nodiscard]] std::optional<ClockOffset> clock_offset(const Timesync& answer,
                                                      std::chrono::nanoseconds now);

}  // namespace gatefly::mavlink
