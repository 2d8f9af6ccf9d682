// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/experiments/upright_picture.hpp"

namespace gatefly::experiments {

// Moves, doubles or covers gates in an RGB picture; their labels go along.

/// Smaller by the mean of what a pixel covers, larger by bilinear interpolation.
[[nodiscard]] UprightPicture resized(const UprightPicture& picture, double factor);
/// Clockwise as seen, about the centre, size kept; black where nothing was. Gates with a corner
/// outside are no longer to be found, and no mistake.
[[nodiscard]] UprightPicture rotated(const UprightPicture& picture, double degrees);
/// Left and right exchanged.
[[nodiscard]] UprightPicture flipped(const UprightPicture& picture);

/// The first gate a second time, smaller by `factor`, beside, below or above it; both are labelled.
/// @return nothing without a whole gate, and where there is no room.
[[nodiscard]] std::optional<UprightPicture> with_second_gate(const UprightPicture& picture,
                                                             double factor);

/// A bar of a gate, seen upright.
enum class Bar { kTop, kRight, kBottom, kLeft };
/// Every gate's bar under a band of the darkest colour around it, three bars wide, `part` of the
/// side long, in its middle.
/// @param bar_width  of a side of the label.
[[nodiscard]] UprightPicture with_band(const UprightPicture& picture, Bar bar, double part,
                                       double bar_width);

}  // namespace gatefly::experiments
