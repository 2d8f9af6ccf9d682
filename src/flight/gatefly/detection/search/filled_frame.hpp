// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Score that a frame loses because it is filled [nats]: a screen, a poster or a door has colours
/// of its own, an opening shows what is around the gate too. [ours]
///
/// Chroma just inside the sides less that just outside, mean of all sides, so that a background
/// which changes from one side to the other cancels out; in parts of how the bars stand out from
/// both. And how much luma changes from just outside to just inside, beside how much it varies along
/// the outside: a picture on a plain wall.
/// @param bars_px  middle lines of the bars. @param bar  bar width / side of the middle lines.
/// @param curves  how the lens bends them, in pixels.
[[nodiscard]] double lost_as_filled(const Image& image, const Quad& bars_px, double bar,
                                    const SideCurves& curves);

}  // namespace gatefly
