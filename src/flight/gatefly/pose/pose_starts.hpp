// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/pose/reprojection.hpp"

/// Starting poses of map_pose's descent.
namespace gatefly::reprojection {

/// Position by the attitude of the prior: the point nearest to all lines of sight, Li18 Eq.
/// (7)-(9), each observation of a line giving a plane instead of a ray; nullopt when they leave a
/// direction open.
[[nodiscard]] std::optional<Pose> start_from_rays(const Sights& sights, Active active,
                                                  const PosePrior& prior, const CameraRig& rig);

/// Both poses that look alike at the middle of four points in the gate's plane, without any prior.
///
/// The homography's slope there is S / depth, S being the upper left 2x2 block of a rotation: its
/// larger singular value is 1, and I - SᵀS = c cᵀ gives the third row up to its sign. As Collins
/// and Bartoli 2014 (IPPE).
[[nodiscard]] FixedList<Pose, 2> starts_from_homography(const Sights& sights, Active active,
                                                        const CameraRig& rig);

}  // namespace gatefly::reprojection
