// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/baseline/imu15.hpp"
#include "gatefly/estimation/ahrs.hpp"
#include "gatefly/estimation/drag_filter.hpp"

namespace gatefly::experiments {

/// Of what both filters are told [m], [rad].
inline constexpr double kAltitudeSigma = 0.05, kHeadingSigma = 0.02;

/// One IMU sample, the same for both filters.
struct FilterTick {
  Imu imu;
  Eigen::Vector3d accel_B;  ///< Low-passed.
  double dt = 0.0, yaw = 0.0;
  std::optional<double> z = std::nullopt;  ///< A new altitude, NED [m].
};

/// AHRS and drag filter, as the pilot has them.
struct DragPilot {
  Ahrs ahrs;
  DragFilter filter;

  void step(const FilterTick& tick);
  void fix(const Eigen::Vector3d& p_EB, const Eigen::Vector3d& sigma);
  [[nodiscard]] Eigen::Vector3d position() const { return filter.position(); }
  [[nodiscard]] Eigen::Vector3d accel_bias() const {
    return filter.state().segment<3>(drag_model::kBiasX);
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
  [[nodiscard]] Eigen::Vector3d accel_bias() const { return filter.accel_bias(); }
};

}  // namespace gatefly::experiments
