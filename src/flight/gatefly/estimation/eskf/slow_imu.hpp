// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/estimation/arrival_clock.hpp"
#include "gatefly/estimation/eskf/delay_ring.hpp"

namespace gatefly::eskf {

/// An IMU as an autopilot hands it on: seldom, low-passed, without stamps.
///
/// Ours. Between two samples everything is taken for a straight line (the trapezoid rule: a sample
/// that held until the next one came would be half an interval late), cut into pieces as long as the
/// filter's ticks. No clock, no libm.
class SlowImu {
 public:
  explicit SlowImu(double nominal_hz) : clock_{nominal_hz} {}

  /// How many pieces come of an interval of `dt` [s].
  [[nodiscard]] static int pieces_in(double dt);

  /// One that arrived at `time` [s], later than the one before.
  void add(const Imu& imu, double time);

  /// From the last sample but one to the last; none while there is one only.
  [[nodiscard]] FixedList<Sample, kMaxSamples> pieces() const;

  [[nodiscard]] const ArrivalClock& clock() const { return clock_; }
  [[nodiscard]] const Imu& last() const { return last_; }

 private:
  ArrivalClock clock_;
  Imu before_, last_;
};

}  // namespace gatefly::eskf
