// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// How closely the sides of a frame are looked at.
enum class RefinementEffort {
  kQuick,    ///< 16 lines of pixels across a side, at most three times.
  kCareful,  ///< 32, at most five times.
};

/// The corners of a frame, sub-pixel: where the middle lines of its bars cross. [ours; Li18 §3.1
/// ends at "the centroid of the patch around each rough corner"]
///
/// What is bar and what is beside it is told by the colours in this very picture: a colour model's
/// bins are as coarse as the noise of a camera, and its steps move a line by a pixel between two
/// pictures of one scene.
/// @param frame  the bars' middle lines, to a pixel or two [px].
/// @param bar  bar width / side of the bars' middle lines.
/// @param curves  how the lens bends the sides, in pixels. Where nobody knows the lens and a strong
///     one would bend a side by a pixel, one bend for the frame is fitted with its sides.
/// A side that shows no bar stays where it is; a frame of which a corner would leap is returned as
/// it was. Allocates nothing.
[[nodiscard]] Quad refined_corners(const Image& image, const Quad& frame, double bar,
                                   RefinementEffort effort = RefinementEffort::kCareful,
                                   const SideCurves& curves = {});

}  // namespace gatefly
