// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "gatefly/config/config.hpp"
#include "gatefly/files/image_file.hpp"

namespace gatefly::tasks {

/// Makes stored pictures upright: by --rotate or a camera that was named; else a raw picture by the
/// camera that it needs anyway, others by their EXIF; else they are upright.
class Upright {
 public:
  /// @param config  its camera.stored_rotation_deg counts where somebody has set it.
  explicit Upright(const config::Config& config);

  [[nodiscard]] bool told() const { return !by_.empty(); }
  /// How far to turn a picture counter-clockwise.
  /// @throws std::runtime_error when the picture's EXIF says that it is mirrored.
  [[nodiscard]] int rotation_deg(const files::ImageFile& file, const std::filesystem::path& path);
  [[nodiscard]] Image view(const files::ImageFile& file, const std::filesystem::path& path) {
    return file.view(rotation_deg(file, path));
  }
  /// "3 pictures turned by 90 degrees counter-clockwise (EXIF), 2 taken as upright": so far.
  [[nodiscard]] std::string said() const;

 private:
  int camera_deg_;
  std::string by_;                     ///< Its author; "" when nobody.
  std::map<std::string, int> done_{};  ///< Number of pictures by deed.
};

}  // namespace gatefly::tasks
