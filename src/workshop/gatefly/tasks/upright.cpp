// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/upright.hpp"

#include <stdexcept>

#include "gatefly/files/text.hpp"

namespace gatefly::tasks {

Upright::Upright(const config::Config& config) : camera_deg_{config.camera.stored_rotation_deg} {
  const auto set = config.set_by.find("camera.stored_rotation_deg");
  if (set != config.set_by.end()) by_ = set->second == "--set" ? "as told" : set->second;
}

int Upright::rotation_deg(const files::ImageFile& file, const std::filesystem::path& path) {
  int degrees = 0;
  std::string by = by_;
  if (told() || files::is_raw(path)) {
    degrees = camera_deg_;
    if (!told()) by = "the default camera's";
  } else if (file.exif_orientation != 0) {
    const auto turn = files::exif_rotation_deg(file.exif_orientation);
    if (!turn)
      throw std::runtime_error(path.string() + ": its EXIF orientation " +
                               std::to_string(file.exif_orientation) +
                               " mirrors it, which is not undone; --rotate takes it as it is");
    degrees = *turn, by = "EXIF";
  }
  const std::string what =
      degrees == 0 ? "taken as upright"
                   : "turned by " + std::to_string(degrees) + " degrees counter-clockwise";
  ++done_[what + (by.empty() ? "" : " (" + by + ")")];
  return degrees;
}

std::string Upright::said() const {
  std::vector<std::string> parts;
  for (const auto& [what, count] : done_)
    parts.push_back(std::to_string(count) + (count == 1 ? " picture " : " pictures ") + what);
  return files::joined(parts);
}

}  // namespace gatefly::tasks
