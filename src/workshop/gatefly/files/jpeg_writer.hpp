// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gatefly/sensing/image.hpp"

namespace gatefly::files {

/// A picture, upright, as the bytes of a small JPEG: for people to look at, not to measure in.
/// @param quality  1..100
/// @param step     every so many pixels across and down are kept.
/// @throws std::invalid_argument when the picture is empty or larger than a JPEG can be.
[[nodiscard]] std::string small_jpeg(const Image& image, int quality, int step = 1);

/// How many pixels share a chroma: none, or two by two as most cameras and films have it.
enum class ChromaSampling { k444, k420 };

/// A picture, upright, as the bytes of a JPEG by libjpeg's tables.
/// @param quality  1..100
/// @throws std::invalid_argument when the picture is empty or larger than a JPEG can be.
[[nodiscard]] std::string jpeg_of(const Image& image, int quality, ChromaSampling sampling);

/// How pictures were kept.
enum class Recording {
  kJpeg,     ///< Quality 98, 4:2:2: as the authors' hand-picked ones (basement32_hq, cyberzoo).
  kMjpegLow  ///< MPEG-1's matrix times 25/8, 4:2:2: as their basement580.
};

/// A stored picture as the bytes of such a JPEG.
/// @param exif_orientation  1..8, which a reader turns it by; 0: says nothing.
/// @throws std::invalid_argument when the picture is empty or larger than a JPEG can be.
[[nodiscard]] std::string recorded_jpeg(const Image& image, Recording recording,
                                        int exif_orientation = 0);

}  // namespace gatefly::files
