// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace gatefly {

/// A line of sight; both members in the same frame.
struct Ray {
  Eigen::Vector3d point;      ///< Any point on the line [m].
  Eigen::Vector3d direction;  ///< Unit length, from the camera towards the point.
};

/// The point nearest to all rays, in their frame [m]: the camera, if each ray goes to a gate
/// corner.
///
/// Source: Li18 §3.2, Eq. (7)-(9), in closed form; derivation in docs/derivations/rays.md.
/// Differs: the paper prints Σ D, we minimise Σ D² (docs/paper/deviations.md#eq-9).
///
/// @param rays        any number, any order.
/// @param min_spread  smallest mean sin² between the rays and their common direction, 0..1.
/// @return            nullopt when the rays are too few or too parallel to tell the distance, or
///     when a point would lie behind the camera.
[[nodiscard]] std::optional<Eigen::Vector3d> nearest_point(std::span<const Ray> rays,
                                                           double min_spread = 1e-5);

}  // namespace gatefly
