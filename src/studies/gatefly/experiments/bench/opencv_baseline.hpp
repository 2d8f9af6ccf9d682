// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"
#include "gatefly/experiments/bench/picture.hpp"
#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/sensing/color_range.hpp"

// The pipeline that everybody would write first with OpenCV, to compare with. One thread.

namespace gatefly::bench {

/// Whether OpenCV was there when this was built; what follows answers nothing without it.
[[nodiscard]] bool has_opencv();

/// UYVY -> BGR -> HSV -> inRange (orange) -> findContours -> approxPolyDP: convex quads, in the
/// stored picture.
/// @return how many.
[[nodiscard]] int opencv_quads(const Picture& picture);

/// Camera position in the gate's frame from the four outer corners' directions, by cv::solvePnP.
[[nodiscard]] std::optional<Eigen::Vector3d> opencv_position(
    const std::array<Eigen::Vector3d, 4>& bearings_C, double side);

/// The ways to a pose that cv::solvePnP knows.
enum class OpenCvPose { kP3p, kIppeSquare, kIppe, kSqpnp, kIterative };

/// Distance along the camera's axis of a 1 m gate that a straight lens sees, by cv::solvePnP.
[[nodiscard]] double opencv_distance(const Quad& px, double focal_px,
                                     const Eigen::Vector2d& center_px, OpenCvPose way);

}  // namespace gatefly::bench
