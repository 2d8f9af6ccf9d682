// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/estimation/eskf/params.hpp"
#include "gatefly/estimation/eskf/process.hpp"

namespace gatefly::eskf {

/// How strongly an IMU shakes in this flight, against the flights that the noise was measured on.
///
/// Ours. Second differences of the samples leave out what the drone does: of white noise of variance
/// σ² they have 6 σ², of a motion of frequency ω its (ω dt)⁴. No clock, no libm.
class Vibration {
 public:
  explicit Vibration(const Noise& noise) : noise_{noise} {}

  void add(const Sample& sample);

  // Variances relative to Noise::shaking, within its bounds; 1 before anything is known.
  [[nodiscard]] double accel() const { return accel_; }
  [[nodiscard]] double gyro() const { return gyro_; }

 private:
  Noise noise_;
  Imu last_, before_last_;
  int count_ = 0;
  double accel_ = 1.0, gyro_ = 1.0;
};

}  // namespace gatefly::eskf
