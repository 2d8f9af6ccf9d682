// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/sensing/imu.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/sim/sight.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// IMU with bias, scale, white noise and the rotors' vibration, as measured in the real logs.
///
/// Vibration is a sine at each rotor's frequency (sampled at 512 Hz it aliases, as it does in
/// reality) whose phase wanders; its strength goes with that rotor's speed² and imbalance. Biases
/// move as the IMU warms up.
class ImuModel {
 public:
  ImuModel(const world::SensorTruth& truth, std::uint64_t seed)
      : truth_{truth}, noise_{seed, "imu"}, rumbling_{seed, "imu rumble"} {}
  /// The next interval between two samples [s].
  [[nodiscard]] double next_interval();
  [[nodiscard]] Imu measure(const BodyState& state, double dt);

 private:
  /// The gyro's rumble after another `dt` [rad/s]; it has no mean, so that angles do not drift.
  [[nodiscard]] Eigen::Vector3d rumble(double dt);

  world::SensorTruth truth_;
  Stream noise_;
  Stream rumbling_;
  Eigen::Vector4d phase_{0.0, 1.6, 3.1, 4.7};
  Eigen::Vector3d rumble_ = Eigen::Vector3d::Zero(), slow_ = Eigen::Vector3d::Zero();
  double time_ = 0.0;  ///< Since it was switched on [s].
};

/// Ultrasound: the nearest thing in a cone below; nothing above its range or when tilted too far.
class SonarModel {
 public:
  SonarModel(const world::SensorTruth& truth, std::uint64_t seed)
      : truth_{truth}, noise_{seed, "sonar"} {}
  [[nodiscard]] std::optional<double> measure(const BodyState& state, const Sight* scene);

 private:
  world::SensorTruth truth_;
  Stream noise_;
};

/// Barometric height above the pad with a slow drift.
class BaroModel {
 public:
  BaroModel(const world::SensorTruth& truth, std::uint64_t seed)
      : truth_{truth}, noise_{seed, "baro"} {}
  [[nodiscard]] double measure(const BodyState& state, double dt);

 private:
  world::SensorTruth truth_;
  Stream noise_;
  double drift_ = 0.0;
};

}  // namespace gatefly::sim
