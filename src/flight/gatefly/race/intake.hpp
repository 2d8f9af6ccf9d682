// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "gatefly/race/messages.hpp"
#include "gatefly/sensing/sample_clock.hpp"
#include "gatefly/sensing/sensor_health.hpp"
#include "gatefly/sensing/sensor_watch.hpp"

namespace gatefly {

/// Takes in what the sensors say: readings that cannot be true are refused, and counted.
///
/// A reading that is well goes through as it is, to the bit. An IMU sample that is refused arrives as no number,
/// on which the navigator goes on with the last one; a height that is refused does not arrive; a
/// picture that is refused arrives empty. Allocates nothing, throws nothing.
class Intake {
 public:
  /// @param imu_hz  nominal rate of Sensors::imu.
  explicit Intake(double imu_hz) : clock_{imu_hz} {}

  /// @param rotors_turn  whether readings that stay the same are a fault.
  /// @return what may be used; until the next call.
  const Sensors& take(const Sensors& sensors, bool rotors_turn);

  [[nodiscard]] const SensorHealth& health() const { return health_; }
  /// The IMU that is estimated by says the same again and again.
  [[nodiscard]] bool imu_stuck() const { return has_slow_ ? slow_.stuck() : imu_.stuck(); }
  /// How long ago the last picture came, whatever was in it [s]; 0 before the first, of which nobody
  /// knows when it should come.
  [[nodiscard]] double since_picture() const { return has_picture_ ? time_ - picture_at_ : 0.0; }
  /// The mean time from one picture to the next, as long as it may be by those that came [s].
  [[nodiscard]] double picture_interval() const;

 private:
  void take_imu(const Sensors& sensors, bool fresh, bool rotors_turn);
  void take_heights(bool rotors_turn);
  void take_picture();
  bool counts(SensorFault fault);

  SampleClock clock_;
  ImuWatch imu_, slow_;
  HeightWatch sonar_, baro_;
  SensorHealth health_;
  Sensors taken_;
  bool has_slow_ = false, has_picture_ = false;
  double time_ = 0.0, picture_at_ = 0.0, interval_ = 0.0;  // [s]
  int intervals_ = 0;                                      ///< That interval_ is the mean of.
  std::uint64_t picture_ = 0;                              ///< Fingerprint of the last one.
};

}  // namespace gatefly
