// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/slow_imu.hpp"

#include <algorithm>

namespace gatefly::eskf {
namespace {

constexpr double kLongestGap = 0.1;  // a gap counts as no more than this [s]

}  // namespace

int SlowImu::pieces_in(double dt) {
  return std::clamp(static_cast<int>(dt * kTickHz + 0.5), 1, static_cast<int>(kMaxSamples));
}

void SlowImu::add(const Imu& imu, double time) {
  before_ = clock_.runs() ? last_ : imu;
  last_ = imu;
  clock_.arrived(time);
}

FixedList<Sample, kMaxSamples> SlowImu::pieces() const {
  FixedList<Sample, kMaxSamples> pieces;
  const double dt = std::min(clock_.interval(), kLongestGap);
  if (!(dt > 0.0)) return pieces;
  const int count = pieces_in(dt);
  for (int i = 0; i < count; ++i) {
    const double part = (i + 0.5) / count;  // its middle
    (void)pieces.push_back({{before_.gyro_B + part * (last_.gyro_B - before_.gyro_B),
                             before_.accel_B + part * (last_.accel_B - before_.accel_B)},
                            dt / count});
  }
  return pieces;
}

}  // namespace gatefly::eskf
