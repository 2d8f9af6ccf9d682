// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/vibration.hpp"

#include <algorithm>

namespace gatefly::eskf {
namespace {

using Eigen::Vector3d;

// A slow gyro's white part, of which so much turns the attitude: the rest, lines of the rotors folded to
// anywhere and rumble, comes back to zero. [ours: NEES / 3 was 1 with a half, .8 with
// all, before peaks counted more than dips; 1.1 with a half since]
constexpr double kTurns = 0.5;
constexpr double kMostSlow = 200.0;  // [ours: a raw gyro at 25 Hz has 70]
// A slow IMU's vibration is believed so much sooner where it grows: rotors shake at once, and a filter
// that takes a second to believe it refuses the pictures that would hold it. What is steady counts as
// 1.9 times what it is, because peaks are followed and dips are not: the safe side. [ours: 23 flights
// behind Betaflight's simulator: height .25 -> .20 m RMS]
constexpr double kSooner = 10.0;

// The white part's variance, all axes together, of samples in a row.
double second_differences(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return (a - 2.0 * b + c).squaredNorm() / 6.0;
}
double third_differences(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                         const Vector3d& d) {
  return (a - 3.0 * b + 3.0 * c - d).squaredNorm() / 20.0;
}

}  // namespace

Vibration::Vibration(const Noise& noise, bool slow)
    : usual_{noise.shaking},
      least_{noise.least_shaking},
      most_{noise.most_shaking},
      lasts_{noise.shaking_lasts},
      slow_{slow} {
  if (!slow) return;
  usual_ = {2.0 * noise.accel + noise.accel_z, 3.0 * noise.attitude / kTurns};
  least_ = 1.0, most_ = kMostSlow;
}

void Vibration::add(const Sample& sample) {
  const Imu& now = sample.imu;
  const auto white = [&](Vector3d Imu::*part) {
    const double variance =
        slow_ ? third_differences(now.*part, last_.*part, before_last_.*part, first_.*part)
              : second_differences(now.*part, last_.*part, before_last_.*part);
    return variance * sample.dt;
  };
  // A sample that repeats the one before (lost on its way) says nothing.
  if (count_ > 0 && now.accel_B == last_.accel_B && now.gyro_B == last_.gyro_B) return;
  if (count_ >= (slow_ ? 3 : 2)) {
    const double gain = std::min(1.0, sample.dt / lasts_);
    const auto follow = [&](double& factor, double seen) {
      // One bad sample is not vibration, and is in up to four differences: each counts as no more than
      // ten times what is usual; three times where growth is believed so soon, which makes 3.8 of it.
      const double part = slow_ && seen > factor ? std::min(1.0, kSooner * gain) : gain;
      factor += part * (std::min(seen, (slow_ ? 3.0 : 10.0) * factor) - factor);
      factor = std::clamp(factor, least_, most_);
    };
    follow(accel_, white(&Imu::accel_B) / usual_.accel);
    follow(gyro_, white(&Imu::gyro_B) / usual_.gyro);
  }
  first_ = before_last_, before_last_ = last_, last_ = now;
  count_ = std::min(count_ + 1, 3);
}

}  // namespace gatefly::eskf
