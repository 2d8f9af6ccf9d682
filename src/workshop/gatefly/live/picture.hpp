// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gatefly/sensing/image.hpp"

namespace gatefly::live {

/// A picture on its way from the camera to the pilot and on to the recorder; its memory is used again and again.
struct Picture {
  std::vector<std::uint8_t> pixels;
  std::vector<std::uint8_t> file;  ///< The file that it came as, e.g. a JPEG; empty: as pixels.
  const char* ending = "";         ///< File name extension: ".jpg".
  PixelFormat format = PixelFormat::kUyvy;
  int stored_width = 0, stored_height = 0;  ///< [px]
  std::chrono::nanoseconds arrived{0};
  /// So much later than the quickest of the last ones, by its stamp; 0 also where it has none.
  std::chrono::nanoseconds late{0};
  std::size_t number = 0;  ///< From 0; of a recorded one its place in the recording.

  [[nodiscard]] Image view(int rotation_deg) const {
    return {pixels.data(), format, stored_width, stored_height, rotation_deg};
  }
};

}  // namespace gatefly::live
