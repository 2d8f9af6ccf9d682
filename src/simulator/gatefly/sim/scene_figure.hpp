// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/sim/scene.hpp"

namespace gatefly::sim {

/// A standing person's size and what they wear, as materials.
struct Figure {
  double height = 1.75;  ///< [m]
  int skin = 0, hair = 0, shirt = 0, trousers = 0;
};

/// Legs, trunk, arms and head, of boxes: 0.46 m wide, 0.26 m deep.
///
/// @param frame  below the middle of the person, who faces along a.
/// @param stride  how far the feet are before and behind the middle [m].
void add_figure(SceneBuilder& builder, const FloorFrame& frame, const Figure& figure,
                double stride = 0.0);

}  // namespace gatefly::sim
