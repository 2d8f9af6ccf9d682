// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/msp_axes.hpp"

#include "gatefly/geometry/math.hpp"
#include "gatefly/link/bytes.hpp"

namespace gatefly::msp {
namespace {

/// (front, left, up) in (front, right, down), and back: half a turn about the front axis.
Eigen::Vector3d half_turn(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

Eigen::Vector3d vector_of(const std::array<std::int16_t, 3>& counts) {
  return {double(counts[0]), double(counts[1]), double(counts[2])};
}

}  // namespace

gatefly::Imu imu_of(const RawImu& raw, const ImuScale& scale) {
  return {half_turn(vector_of(raw.gyro)) * (kDegree / scale.gyro_counts_per_deg_per_s),
          half_turn(vector_of(raw.accel)) * (kGravity / scale.accel_counts_per_g)};
}

gatefly::Attitude attitude_of(const Attitude& attitude) {
  return {wrap_angle(0.1 * kDegree * attitude.roll), -0.1 * kDegree * attitude.pitch,
          wrap_angle(kDegree * attitude.yaw)};
}

// The sticks of roll and yaw go with our rates; pulled back, the pitch stick reads less.
Eigen::Vector3d stick_rates(const Eigen::Vector3d& rates_B) {
  return {rates_B.x(), -rates_B.y(), rates_B.z()};
}

Eigen::Vector3d body_rates(const Eigen::Vector3d& stick_rates) {
  return {stick_rates.x(), -stick_rates.y(), stick_rates.z()};
}

std::optional<ChannelOrder> ChannelOrder::from(const RxMap& map) {
  ChannelOrder order;
  unsigned taken = 0;
  for (std::size_t i = 0; i < order.place_.size(); ++i) {
    if (map.place[i] >= order.place_.size()) return std::nullopt;
    order.place_[i] = map.place[i];
    taken |= 1u << map.place[i];
  }
  if (taken != 0b1111u) return std::nullopt;
  return order;
}

std::array<std::uint8_t, 8> ChannelOrder::set_raw_rc(const Sticks& sticks) const {
  std::array<std::uint16_t, 4> channels{};
  channels[place_[0]] = sticks.roll;
  channels[place_[1]] = sticks.pitch;
  channels[place_[2]] = sticks.yaw;
  channels[place_[3]] = sticks.throttle;
  std::array<std::uint8_t, 8> payload{};
  link::ByteWriter out{payload};
  for (const std::uint16_t channel : channels) out.put(channel);
  return payload;
}

std::optional<Sticks> sticks_in_rc(std::span<const std::uint16_t> channels) {
  if (channels.size() < 4) return std::nullopt;
  return Sticks{
      .roll = channels[0], .pitch = channels[1], .yaw = channels[2], .throttle = channels[3]};
}

}  // namespace gatefly::msp
