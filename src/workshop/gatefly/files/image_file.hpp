// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/sensing/image.hpp"

namespace gatefly::files {

/// A stored picture and its bytes.
struct ImageFile {
  std::vector<std::uint8_t> bytes;
  PixelFormat format = PixelFormat::kYuv444;
  int stored_width = 0, stored_height = 0;  ///< [px]
  int exif_orientation = 0;                 ///< 1..8 as a JPEG's EXIF has it; 0: it has none.

  /// The picture upright; valid as long as this object lives and is not changed.
  /// @param rotation_deg  how far to turn the stored picture counter-clockwise: 0, 90, 180, 270.
  [[nodiscard]] Image view(int rotation_deg) const {
    return Image(bytes.data(), format, stored_width, stored_height, rotation_deg);
  }
};

/// How far a stored picture of such an EXIF orientation has to be turned counter-clockwise; nothing
/// for mirrored ones (2, 4, 5, 7).
[[nodiscard]] std::optional<int> exif_rotation_deg(int orientation);

/// The name's ending in small letters: ".jpg".
[[nodiscard]] std::string kind_of(const std::filesystem::path& path);

/// Whether the name ends as those that read_image() knows, in small or capital letters.
[[nodiscard]] bool is_picture(const std::filesystem::path& path);

/// Whether it is a raw .uyvy, which does not know its own size.
[[nodiscard]] bool is_raw(const std::filesystem::path& path);

/// Reads .jpg/.jpeg straight to full-range Y'CbCr, .png and .ppm (P6, 8 bit) as RGB, or raw .uyvy.
///
/// @param uyvy_width,uyvy_height  stored size of the camera; only a .uyvy needs it.
/// @throws std::runtime_error one line with the path: unreadable, empty, corrupt, wrong size.
[[nodiscard]] ImageFile read_image(const std::filesystem::path& path, int uyvy_width = 0,
                                   int uyvy_height = 0);

/// The picture in a JPEG's bytes, straight to full-range Y'CbCr.
/// @param name  of the file, for its error.
/// @throws std::runtime_error one line: not a usable JPEG, and why.
[[nodiscard]] ImageFile decoded_jpeg(const std::string& name, const std::string& bytes);

}  // namespace gatefly::files

/// The names until 0.3; they go with 0.4.
namespace gatefly::io {
using files::decoded_jpeg;
using files::exif_rotation_deg;
using files::ImageFile;
using files::is_picture;
using files::is_raw;
using files::kind_of;
using files::read_image;
}  // namespace gatefly::io
