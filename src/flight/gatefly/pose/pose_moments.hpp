// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/pose/reprojection.hpp"

namespace gatefly::reprojection {

/// Mean and covariance of (x, y, z of p_GB, roll, pitch, yaw).
struct Moments {
  Eigen::Matrix<double, 6, 1> mean;
  Eigen::Matrix<double, 6, 6> covariance;
};

/// As the curvature at the fit tells (Laplace); nullopt when a direction is left open.
[[nodiscard]] std::optional<Moments> moments_of(const Fit& fit);

/// By numerical integration over the principal axes of its attitude, the position following, each
/// step weighted by its true cost: a far gate seen straight on shows its tilt
/// only in second order, and the curvature there is not what it is a few degrees on. Costs 2-4 µs.
[[nodiscard]] Moments integrated_moments_of(const Fit& fit, const Moments& by_curvature,
                                            const Sights& sights, Active active,
                                            const PosePrior& prior, const CameraRig& rig);

}  // namespace gatefly::reprojection
