// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/vibration.hpp"

#include <algorithm>

namespace gatefly::eskf {

void Vibration::add(const Sample& sample) {
  const Imu& now = sample.imu;
  const auto white = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                         const Eigen::Vector3d& c) {
    return (a - 2.0 * b + c).squaredNorm() / 6.0 * sample.dt;
  };
  // A sample that repeats the one before (lost on its way) says nothing.
  if (count_ > 0 && now.accel_B == last_.accel_B && now.gyro_B == last_.gyro_B) return;
  if (count_ >= 2) {
    const double gain = std::min(1.0, sample.dt / noise_.shaking_lasts);
    const auto follow = [&](double& factor, double seen) {
      // One bad sample is not vibration: it counts as no more than ten times what is usual.
      factor += gain * (std::min(seen, 10.0 * factor) - factor);
      factor = std::clamp(factor, noise_.least_shaking, noise_.most_shaking);
    };
    follow(accel_, white(now.accel_B, last_.accel_B, before_last_.accel_B) / noise_.shaking.accel);
    follow(gyro_, white(now.gyro_B, last_.gyro_B, before_last_.gyro_B) / noise_.shaking.gyro);
  }
  before_last_ = last_, last_ = now;
  count_ = std::min(count_ + 1, 2);
}

}  // namespace gatefly::eskf
