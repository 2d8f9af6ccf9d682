// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly::experiments {

/// One way through a room.
struct Trajectory {
  std::vector<Eigen::Vector3d> points;  ///< Earth frame [m].
  drawing::Color color;
};

/// A course and what was flown on it, seen from above one corner: Li18 Fig. "basement 3D".
///
/// Parallel projection; what stands on the floor is a box of lines, gates stand on a pole.
void draw_track_3d(drawing::Canvas& canvas, const drawing::Box& box, const Track& track,
                   const std::vector<Trajectory>& flown);

}  // namespace gatefly::experiments
