// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/mavlink_axes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly::mavlink {
namespace {

constexpr std::uint8_t kIgnoreRates = 1 | 2 | 4;
constexpr std::uint8_t kIgnoreAttitude = 128;
/// Position, acceleration, rate of yaw.
constexpr std::uint16_t kVelocityAndYawOnly = 7 | 448 | 2048;
constexpr std::uint8_t kLocalNed = 1;  ///< MAV_FRAME_LOCAL_NED

template <class T>
Eigen::Vector3d vector(T x, T y, T z) {
  return {double(x), double(y), double(z)};
}

/// From mg and mrad/s.
template <class Message>
gatefly::Imu from_thousandths(const Message& imu) {
  return {1e-3 * vector(imu.xgyro, imu.ygyro, imu.zgyro),
          1e-3 * kGravity * vector(imu.xacc, imu.yacc, imu.zacc)};
}

/// A thrust that is no number becomes 0.
float part(double thrust) {
  return std::isfinite(thrust) ? static_cast<float>(std::clamp(thrust, 0.0, 1.0)) : 0.0F;
}

std::uint32_t stamp(std::chrono::milliseconds since_start) {
  return static_cast<std::uint32_t>(since_start.count());
}

SetAttitudeTarget target_for(const Target& target, double thrust,
                             std::chrono::milliseconds since_start) {
  SetAttitudeTarget message;
  message.time_boot_ms = stamp(since_start);
  message.q = {1, 0, 0, 0};
  message.thrust = part(thrust);
  message.target_system = target.system;
  message.target_component = target.component;
  return message;
}

}  // namespace

gatefly::Imu imu_of(const HighresImu& imu) {
  return {vector(imu.xgyro, imu.ygyro, imu.zgyro), vector(imu.xacc, imu.yacc, imu.zacc)};
}

gatefly::Imu imu_of(const ScaledImu& imu) { return from_thousandths(imu); }

gatefly::Imu ardupilot_imu_of(const RawImu& imu) { return from_thousandths(imu); }

gatefly::Attitude attitude_of(const Attitude& attitude) {
  return {double(attitude.roll), double(attitude.pitch), double(attitude.yaw)};
}

gatefly::Attitude attitude_of(const AttitudeQuaternion& a) {
  return gatefly::attitude_of(
      rotation_EB(Quaternion{double(a.q1), double(a.q2), double(a.q3), double(a.q4)}));
}

Place place_of(const LocalPositionNed& place) {
  return {vector(place.x, place.y, place.z), vector(place.vx, place.vy, place.vz)};
}

float px4_value_of(const ParamValue& value) {
  constexpr std::uint8_t kInt32 = 6;
  if (value.param_type != kInt32) return value.param_value;
  return static_cast<float>(std::bit_cast<std::int32_t>(value.param_value));
}

SetAttitudeTarget attitude_target(const Target& target, const gatefly::Attitude& attitude,
                                  double thrust, std::chrono::milliseconds since_start) {
  SetAttitudeTarget message = target_for(target, thrust, since_start);
  const Quaternion q = quaternion_of(attitude);
  message.q = {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
               static_cast<float>(q.z)};
  message.type_mask = kIgnoreRates;
  return message;
}

SetAttitudeTarget rate_target(const Target& target, const Eigen::Vector3d& rates_B, double thrust,
                              std::chrono::milliseconds since_start) {
  SetAttitudeTarget message = target_for(target, thrust, since_start);
  message.body_roll_rate = static_cast<float>(rates_B.x());
  message.body_pitch_rate = static_cast<float>(rates_B.y());
  message.body_yaw_rate = static_cast<float>(rates_B.z());
  message.type_mask = kIgnoreAttitude;
  return message;
}

SetPositionTargetLocalNed velocity_target(const Target& target, const Eigen::Vector3d& v_E,
                                          double yaw, std::chrono::milliseconds since_start) {
  SetPositionTargetLocalNed message;
  message.time_boot_ms = stamp(since_start);
  message.vx = static_cast<float>(v_E.x());
  message.vy = static_cast<float>(v_E.y());
  message.vz = static_cast<float>(v_E.z());
  message.yaw = static_cast<float>(yaw);
  message.type_mask = kVelocityAndYawOnly;
  message.coordinate_frame = kLocalNed;
  message.target_system = target.system;
  message.target_component = target.component;
  return message;
}

Timesync clock_question(std::chrono::nanoseconds now) { return {.tc1 = 0, .ts1 = now.count()}; }

std::optional<Timesync> clock_answer(const Timesync& question, std::chrono::nanoseconds now) {
  if (question.tc1 != 0) return std::nullopt;
  return Timesync{.tc1 = now.count(), .ts1 = question.ts1};
}

std::optional<ClockOffset> clock_offset(const Timesync& answer, std::chrono::nanoseconds now) {
  // Within these neither sum nor difference leaves 64 bits: 146 years.
  constexpr std::int64_t kSane = std::int64_t{1} << 62;
  const auto sane = [](std::int64_t t) { return t > -kSane && t < kSane; };
  const std::int64_t received = now.count();
  if (answer.tc1 == 0 || !sane(answer.tc1) || !sane(answer.ts1) || !sane(received)) return {};
  const std::int64_t round_trip = received - answer.ts1;
  if (round_trip < 0) return std::nullopt;
  // It was answered halfway, as far as anybody knows.
  const std::int64_t ours = answer.ts1 + round_trip / 2;
  return ClockOffset{std::chrono::nanoseconds{answer.tc1 - ours},
                     std::chrono::nanoseconds{round_trip}};
}

}  // namespace gatefly::mavlink
