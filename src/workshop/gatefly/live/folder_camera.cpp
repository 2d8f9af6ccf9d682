// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/folder_camera.hpp"

#include <stdexcept>
#include <thread>

#include "gatefly/files/text.hpp"

namespace gatefly::live {

FolderCamera::FolderCamera(const std::filesystem::path& folder, StoredSize size, bool paced)
    : folder_{flight_log::read_flight_folder(folder)}, paced_{paced} {
  const auto where = flight_log::where_pictures_are(folder_);
  if (where == flight_log::Pictures::kHashes || where == flight_log::Pictures::kNone)
    throw std::runtime_error(folder.string() + ": keeps no pictures (fly it with --frames)");
  source_ = where == flight_log::Pictures::kFilm
                ? flight_log::pictures_in_film(folder_, size.width, size.height)
                : flight_log::pictures_in_files(folder_, size.width, size.height);
  start_ = Clock::now();
}

Camera::Got FolderCamera::next(Picture& picture, Moment deadline) {
  if (next_ >= folder_.images.size()) return Got::kEnded;
  if (paced_) {
    const Moment due = start_ + (folder_.images[next_].time - folder_.images.front().time);
    std::this_thread::sleep_until(std::min(due, deadline));
    if (due > deadline) return Got::kNothing;
  }
  const files::ImageFile& file = source_(next_);
  const std::filesystem::path& path = folder_.images[next_].path;
  picture.pixels.assign(file.bytes.begin(), file.bytes.end());
  picture.file.clear();
  if (file.format != PixelFormat::kUyvy) {
    const std::string bytes = files::read_file(path), kind = files::kind_of(path);
    picture.file.assign(bytes.begin(), bytes.end());
    picture.ending = kind == ".png" ? ".png" : kind == ".ppm" ? ".ppm" : ".jpg";
  }
  picture.format = file.format;
  picture.stored_width = file.stored_width, picture.stored_height = file.stored_height;
  picture.late = folder_.images[next_].late;
  picture.number = next_++;
  return Got::kPicture;
}

}  // namespace gatefly::live
