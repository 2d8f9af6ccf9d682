// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>

#include "gatefly/estimation/low_pass.hpp"
#include "gatefly/sensing/imu.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::closed_loop {

/// An autopilot between the IMU and the estimator: it filters every sample, and hands some on.
///
/// They are taken regularly and arrive in order, each a little late, one a tick at most.
class AutopilotImu {
 public:
  AutopilotImu(const sim::SensorTruth& truth, std::uint64_t seed)
      : gyro_{low_pass(truth.autopilot_gyro_cutoff, truth.imu_hz)},
        accel_{low_pass(truth.autopilot_accel_cutoff, truth.imu_hz)},
        period_{1.0 / truth.autopilot_imu_hz},
        jitter_{truth.autopilot_imu_jitter},
        lateness_{seed, "autopilot imu"} {}

  /// One sample of the IMU, at `time` [s]. @return what arrives at the estimator now, if anything.
  [[nodiscard]] std::optional<Imu> pass_on(const Imu& imu, double time) {
    const Imu filtered = this->filtered(imu);
    if (!next_ || time >= *next_) {
      next_ = next_.value_or(time) + period_;
      const double arrival = time + std::abs(lateness_.normal_cut(jitter_));
      last_arrival_ = std::max(last_arrival_, arrival);
      on_their_way_.push_back({filtered, last_arrival_});
    }
    if (on_their_way_.empty() || time < on_their_way_.front().arrival) return std::nullopt;
    const Imu arrived = on_their_way_.front().imu;
    on_their_way_.pop_front();
    return arrived;
  }

 private:
  struct Sent {
    Imu imu;
    double arrival = 0.0;  ///< [s]
  };

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
  double period_, jitter_;  ///< [s]
  sim::Stream lateness_;
  std::optional<double> next_;  ///< When the next one is taken [s].
  std::deque<Sent> on_their_way_;
  double last_arrival_ = 0.0;  ///< Of those that were taken [s].
};

}  // namespace gatefly::closed_loop
