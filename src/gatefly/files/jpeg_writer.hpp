// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gatefly/sensing/image.hpp"

namespace gatefly::io {

/// A picture, upright, as the bytes of a small JPEG: for people to look at, not to measure in.
/// @param quality  1..100
/// @param step     every so many pixels across and down are kept.
/// @throws std::invalid_argument when the picture is empty or larger than a JPEG can be.
[[nodiscard]] std::string small_jpeg(const Image& image, int quality, int step = 1);

}  // namespace gatefly::io
