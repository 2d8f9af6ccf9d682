// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/betaflight_sitl.hpp"

#include "gatefly/geometry/math.hpp"

namespace gatefly::betaflight_sitl {
namespace {

constexpr double kDegreesPerMetre = 1.0 / 111'319.5;  ///< Along a meridian.
constexpr double kPascalPerMetre = 11.7;              ///< Near the ground.

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

/// The same rotation seen in axes that are turned by half about x.
Quaternion about_x(const Quaternion& q) { return {q.w, q.x, -q.y, -q.z}; }

/// Its reader turns by half about x, then by a quarter to the left, and has the body (front, left, up) in
/// north, west, up; here the other way round.
Quaternion before_its_turns(const gatefly::Attitude& attitude) {
  constexpr double kHalfRoot = 0.70710678118654752440;
  const Quaternion quarter_right{kHalfRoot, 0.0, 0.0, -kHalfRoot};
  return about_x(product(quarter_right, about_x(quaternion_of(attitude))));
}

void put(link::ByteWriter& out, double a, double b, double c) {
  out.put(a);
  out.put(b);
  out.put(c);
}

}  // namespace

std::array<std::uint8_t, kStateSize> encode_state(const State& state, Release release,
                                                  const Origin& origin) {
  const Eigen::Vector3d& gyro = state.imu.gyro_B;
  const Eigen::Vector3d& accel = state.imu.accel_B;
  const Quaternion q = before_its_turns(state.attitude);
  const double height = -state.p_EB.z();
  std::array<std::uint8_t, kStateSize> bytes{};
  link::ByteWriter out{bytes};
  out.put(std::chrono::duration<double>(state.time).count());
  put(out, gyro.x(), gyro.y(), release == Release::k4_5 ? gyro.z() : -gyro.z());
  put(out, -accel.x(), accel.y(), accel.z());
  out.put(q.w);
  put(out, q.x, q.y, q.z);
  put(out, state.v_E.y(), state.v_E.x(), -state.v_E.z());
  put(out,
      origin.longitude_deg + state.p_EB.y() * kDegreesPerMetre / cos(origin.latitude_deg * kDegree),
      origin.latitude_deg + state.p_EB.x() * kDegreesPerMetre, height);
  out.put(origin.pressure_pa - kPascalPerMetre * height);
  return bytes;
}

std::optional<std::array<float, 4>> motors_in(Bytes datagram) {
  constexpr std::size_t kSize = 4 * sizeof(float);
  if (datagram.size() != kSize) return std::nullopt;
  return link::ByteReader{datagram}.take_array<float, 4>();
}

std::optional<RawServos> raw_servos_in(Bytes datagram) {
  constexpr std::size_t kSize = 4 + 16 * sizeof(float);
  if (datagram.size() != kSize) return std::nullopt;
  link::ByteReader in{datagram};
  RawServos servos;
  servos.motors = in.take<std::uint16_t>();
  (void)in.take<std::uint16_t>();  // its compiler's alignment
  servos.pulse_us = in.take_array<float, 16>();
  if (servos.motors > servos.pulse_us.size()) return std::nullopt;
  return servos;
}

std::array<std::uint8_t, kReceiverSize> encode_receiver(std::chrono::nanoseconds time,
                                                        const msp::Sticks& sticks,
                                                        const std::array<std::uint16_t, 12>& aux) {
  std::array<std::uint8_t, kReceiverSize> bytes{};
  link::ByteWriter out{bytes};
  out.put(std::chrono::duration<double>(time).count());
  out.put_bytes(msp::ChannelOrder{}.set_raw_rc(sticks));
  for (const std::uint16_t pulse : aux) out.put(pulse);
  return bytes;
}

}  // namespace gatefly::betaflight_sitl
