// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace gatefly::sim {

/// A UYVY picture as it comes back from a camera that sends JPEGs: 4:2:0, baseline, Annex K's tables.
///
/// @param width, height  as stored [px]; the width is even.
/// @param quality        1..100, as libjpeg counts.
void through_jpeg(std::vector<std::uint8_t>& uyvy, int width, int height, int quality);

}  // namespace gatefly::sim
