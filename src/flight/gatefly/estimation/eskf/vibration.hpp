// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/estimation/eskf/params.hpp"
#include "gatefly/estimation/eskf/process.hpp"

namespace gatefly::eskf {

/// How strongly an IMU shakes in this flight, against the flights that the noise was measured on.
///
/// Ours. Second differences of the samples leave out what the drone does: of white noise of variance
/// σ² they have 6 σ², of a motion of frequency ω its (ω dt)⁴. Of an autopilot's slow IMU third ones are
/// taken, with 20 σ² and (ω dt)⁶: vibration that is folded down by aliasing moves velocity and attitude
/// as white noise does, so that what they show is compared with those densities themselves. Less than
/// these a low-passed IMU cannot show; half of what begins is believed within a quarter of a second, so that
/// what is steady counts as twice what it is. No clock, no libm.
class Vibration {
 public:
  explicit Vibration(const Noise& noise, bool slow = false);

  void add(const Sample& sample);

  // Variances relative to the usual ones, within Noise's bounds; 1 before anything is known.
  [[nodiscard]] double accel() const { return accel_; }
  [[nodiscard]] double gyro() const { return gyro_; }

 private:
  Shaking usual_;
  double least_, most_, lasts_;
  bool slow_;
  Imu last_, before_last_, first_;  ///< The last three samples, the youngest first.
  int count_ = 0;
  double accel_ = 1.0, gyro_ = 1.0;
};

}  // namespace gatefly::eskf
