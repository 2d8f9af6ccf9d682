// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include "gatefly/sensing/imu.hpp"
#include "gatefly/world/faults.hpp"

namespace gatefly::sim {

/// Faults between a sensor and the pilot. Without faults everything comes through as it is.
class SensorFaults {
 public:
  explicit SensorFaults(const world::Faults& faults) : faults_{faults} {}

  /// The stamp of a moment: the clock may have jumped.
  [[nodiscard]] std::chrono::nanoseconds stamp(double time) const;
  /// A sample taken at `time` [s], as it arrives; samples in order.
  [[nodiscard]] Imu broken(const Imu& imu, double time);
  /// A reading of the sonar, as it arrives.
  [[nodiscard]] std::optional<double> broken(std::optional<double> sonar, double time) const;

 private:
  world::Faults faults_;
  Imu last_;  ///< That came through.
};

}  // namespace gatefly::sim
