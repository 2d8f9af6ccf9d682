// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"

namespace gatefly::experiments {

/// OpenCV's ways to a pose from four corners, without any attitude. Baselines: nothing flies them.
enum class Pnp {
  kP3p,  ///< Three corners, the fourth chooses among up to four solutions.
  kIppe,
  kIppeSquare,
  kSqpnp,
  kIterative,  ///< Homography, then Levenberg-Marquardt.
};

/// Whether this program was built with OpenCV.
[[nodiscard]] bool has_pnp();
/// Remedy when not, as one line.
inline constexpr const char* kNoPnp =
    "not built: apt-get install libopencv-calib3d-dev, then build again";

/// Place of the camera relative to a gate [m, frame G]; nullopt without solution or OpenCV.
///
/// @param corners  TL TR BR BL, drawn by a straight lens of `focal_px` centred at the origin.
[[nodiscard]] std::optional<Eigen::Vector3d> camera_by(Pnp method, const Quad& corners,
                                                       double focal_px, double side);

}  // namespace gatefly::experiments
