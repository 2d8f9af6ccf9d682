// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/estimation/navigator.hpp"
#include "gatefly/flight_log/baseline/imu15.hpp"

namespace gatefly::experiments {

/// Noise of both filters' inputs [m], [rad].
inline constexpr double kAltitudeSigma = 0.05, kHeadingSigma = 0.02;

/// One IMU sample, the same for both filters.
struct FilterTick {
  Imu imu;
  double t = 0.0, dt = 0.0;                ///< [s]
  double yaw = 0.0;                        ///< Given to both with an altitude [rad].
  std::optional<double> z = std::nullopt;  ///< A new altitude, NED [m].
};

/// The estimation that flies.
struct DragPilot {
  Navigator navigator;

  void step(const FilterTick& tick);
  void fix(const Eigen::Vector3d& p_EB, const Eigen::Vector3d& sigma);
  [[nodiscard]] Eigen::Vector3d position() const { return navigator.p_EB(); }
  [[nodiscard]] Eigen::Vector3d velocity() const { return navigator.state().v_E; }
  [[nodiscard]] Attitude attitude() const { return navigator.ahrs().attitude(); }
  [[nodiscard]] Eigen::Vector3d accel_bias() const {
    return navigator.filter().state().segment<3>(drag_model::kBiasX);
  }
};

/// The classic inertial filter, told the same.
struct InertialPilot {
  baseline::Imu15 filter;

  void step(const FilterTick& tick);
  void fix(const Eigen::Vector3d& p_EB, const Eigen::Vector3d& sigma) {
    filter.correct_position(p_EB, sigma);
  }
  [[nodiscard]] Eigen::Vector3d position() const { return filter.position(); }
  [[nodiscard]] Eigen::Vector3d velocity() const { return filter.velocity(); }
  [[nodiscard]] Attitude attitude() const { return filter.attitude(); }
  [[nodiscard]] Eigen::Vector3d accel_bias() const { return filter.accel_bias(); }
};

}  // namespace gatefly::experiments
