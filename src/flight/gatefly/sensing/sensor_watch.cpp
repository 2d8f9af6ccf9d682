// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sensing/sensor_watch.hpp"

#include <cmath>
#include <cstddef>
#include <cstring>

namespace gatefly {
namespace {

// Beyond any MEMS range a number is as broken as NaN, and would become one inside.
constexpr double kMostGyro = 100.0, kMostAccel = 400.0;  // [rad/s] [m/s²]
constexpr double kMostRange = 100.0, kMostHeight = 1e3;  // [m]
constexpr int kEqualSamples = 8;                         // of a slow IMU, 5 in 0.1 s. [estimate]
constexpr double kStuckImu = 0.1;                        // [s] [reliability: F8]
constexpr int kEqualHeights = 20;                        // 1 s at 20 Hz, coarse ones. [estimate]
constexpr double kStuckHeight = 2.0;                     // [s] [estimate]
constexpr double kLargeGyro = 4.0, kLargeAccel = 30.0;   // 230 °/s, 3 g: less is no range's end

SensorFault fault_of_number(double value, double least, double most) {
  if (!std::isfinite(value)) return SensorFault::kNotFinite;
  return value > least && value < most ? SensorFault::kNone : SensorFault::kOutOfRange;
}

bool comes_twice(const Eigen::Vector3d& now, const Eigen::Vector3d& before, double large) {
  for (int i = 0; i < 3; ++i)
    if (now[i] == before[i] && std::abs(now[i]) > large) return true;
  return false;
}

}  // namespace

SensorFault fault_of(const Imu& imu) {
  if (!imu.gyro_B.allFinite() || !imu.accel_B.allFinite()) return SensorFault::kNotFinite;
  const bool possible = imu.gyro_B.cwiseAbs().maxCoeff() < kMostGyro &&
                        imu.accel_B.cwiseAbs().maxCoeff() < kMostAccel;
  return possible ? SensorFault::kNone : SensorFault::kOutOfRange;
}

SensorFault fault_of_sonar(double range) { return fault_of_number(range, 0.0, kMostRange); }
SensorFault fault_of_baro(double height) {
  return fault_of_number(height, -kMostHeight, kMostHeight);
}

std::uint64_t fingerprint_of(const Image& image) {
  // Pieces at multiples of 24 bytes begin with the same channel in every format.
  constexpr std::size_t kPieces = 256, kAligned = 24;
  constexpr std::uint64_t kBasis = 0xcbf29ce484222325, kPrime = 0x100000001b3;
  const auto bytes = image.bytes();
  if (bytes.size() < kAligned) return 0;
  const std::size_t step = (bytes.size() / kPieces / kAligned + 1) * kAligned;
  std::uint64_t hash = kBasis, first = 0;
  bool differs = false;
  // At most kPieces times.
  for (std::size_t i = 0; i + sizeof first <= bytes.size(); i += step) {
    std::uint64_t piece = 0;
    std::memcpy(&piece, bytes.data() + i, sizeof piece);
    if (i == 0) first = piece;
    differs = differs || piece != first;
    hash = (hash ^ piece) * kPrime;
  }
  return differs ? hash | 1 : 0;
}

SensorFault ImuWatch::judge(const Imu& imu, double time, bool rotors_turn) {
  saturated_ = false;
  const SensorFault fault = fault_of(imu);
  if (fault != SensorFault::kNone) {
    stuck_ = false;
    return fault;
  }
  const bool same = imu.gyro_B == last_.gyro_B && imu.accel_B == last_.accel_B;
  same_.update(same, rotors_turn, time);
  stuck_ = same_.is(kEqualSamples, kStuckImu);
  saturated_ = !same && (comes_twice(imu.gyro_B, last_.gyro_B, kLargeGyro) ||
                         comes_twice(imu.accel_B, last_.accel_B, kLargeAccel));
  last_ = imu;
  return stuck_ ? SensorFault::kStuck : SensorFault::kNone;
}

SensorFault HeightWatch::judge(double height, SensorFault fault, double time, bool rotors_turn) {
  if (fault != SensorFault::kNone) return fault;
  same_.update(height == last_, rotors_turn, time);
  last_ = height;
  return same_.is(kEqualHeights, kStuckHeight) ? SensorFault::kStuck : SensorFault::kNone;
}

}  // namespace gatefly
