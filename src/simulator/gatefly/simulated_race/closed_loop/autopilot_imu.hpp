// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "gatefly/estimation/low_pass.hpp"
#include "gatefly/sensing/imu.hpp"
#include "gatefly/sim/late_line.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::simulated_race {

/// An autopilot between the IMU and the estimator: it filters every sample, and hands some on.
///
/// They are taken regularly and arrive in order, each a little late, one a tick at most.
class AutopilotImu {
 public:
  AutopilotImu(const world::SensorTruth& truth, std::uint64_t seed)
      : gyro_{low_pass(truth.autopilot_gyro_cutoff, truth.imu_hz)},
        accel_{low_pass(truth.autopilot_accel_cutoff, truth.imu_hz)},
        line_{truth.autopilot_imu_hz, 0.0, truth.autopilot_imu_jitter, {seed, "autopilot imu"}} {}

  /// One sample of the IMU, at `time` [s]. @return what arrives at the estimator now, if anything.
  [[nodiscard]] std::optional<Imu> pass_on(const Imu& imu, double time) {
    const Imu filtered = this->filtered(imu);
    if (line_.is_due(time)) line_.send(filtered, time);
    return line_.arrived(time);
  }

 private:
  [[nodiscard]] static std::optional<LowPass> low_pass(double cutoff_hz, double imu_hz) {
    if (!(cutoff_hz > 0.0)) return std::nullopt;
    return LowPass{cutoff_hz, imu_hz};
  }

  /// A value that is no number goes through, and the filters do not remember it.
  [[nodiscard]] Imu filtered(const Imu& imu) {
    if (!imu.gyro_B.allFinite() || !imu.accel_B.allFinite()) return imu;
    return {gyro_ ? gyro_->update(imu.gyro_B) : imu.gyro_B,
            accel_ ? accel_->update(imu.accel_B) : imu.accel_B};
  }

  std::optional<LowPass> gyro_, accel_;
  sim::LateLine<Imu> line_;
};

}  // namespace gatefly::simulated_race
