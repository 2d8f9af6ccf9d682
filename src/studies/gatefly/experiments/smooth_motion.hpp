// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::experiments {

/// One sample of a motion that is known from outside: by motion capture, or because it is simulated.
struct MotionSample {
  double t = 0.0;                                 ///< [s]
  Eigen::Vector3d p_E = Eigen::Vector3d::Zero();  ///< z down [m].
  Attitude attitude;                              ///< Body to E.
};

/// The motion near one sample: polynomials through its neighbours, outliers left out.
struct SmoothSample {
  double t = 0.0;
  Eigen::Vector3d p_E = Eigen::Vector3d::Zero(), v_E = Eigen::Vector3d::Zero();
  double pitch = 0.0;
  double yaw = 0.0;       ///< Without jumps of whole turns [rad].
  double yaw_rate = 0.0;  ///< [rad/s]
  /// There are enough neighbours on both sides. Else nothing but t is set.
  bool tracked = false;
};

struct SmoothingParams {
  /// Neighbours that count, to both sides [s]. [ours: an attitude loop of 14 rad/s is slower]
  double half_window = 0.075;
  /// Longer without a sample: lost [s]. [ours: five samples of 120 Hz]
  double max_gap = 0.042;
};

/// Position by a robust parabola, heading by a robust line around each sample; times increase.
[[nodiscard]] std::vector<SmoothSample> smoothed(std::span<const MotionSample> samples,
                                                 const SmoothingParams& params = {});

/// The motion between its samples; before the first and after the last: those.
[[nodiscard]] SmoothSample at(std::span<const SmoothSample> motion, double t);

}  // namespace gatefly::experiments
