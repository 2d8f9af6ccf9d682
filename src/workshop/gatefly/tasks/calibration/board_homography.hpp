// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/tasks/calibration/lens_fit.hpp"

namespace gatefly::calibration {

/// The board's pose from the homography between its plane and the lens's rays, without iteration.
///
/// Rays instead of a flat picture [Zhang 2000]: fisheyes have directions that no flat picture
/// holds. nullopt with fewer than 4 corners in the lens's view, all on a line, or behind the
/// camera.
[[nodiscard]] std::optional<BoardPose> pose_from_homography(const BoardView& view,
                                                            const AnyCamera& lens);

}  // namespace gatefly::calibration
