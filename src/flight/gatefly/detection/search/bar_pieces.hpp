// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/detection/search/bar_finder.hpp"

namespace gatefly {

/// The place of a bar at row y [px]: along its curve, straight on beyond its ends.
[[nodiscard]] Eigen::Vector2d beyond(const Bar& bar, double y);

/// Makes one bar of pieces that continue each other: something before a bar may hide some of its rows.
/// @param stride  rows of pixels from one that is read to the next.
void join_pieces(BarFinder::Bars& bars, int stride);

}  // namespace gatefly
