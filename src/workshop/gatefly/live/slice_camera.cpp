// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/slice_camera.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "gatefly/files/image_file.hpp"

namespace gatefly::live {

SliceCamera::SliceCamera(Port port, StoredSize size)
    : port_{std::move(port)}, size_{size}, room_(65536) {}

Camera::Got SliceCamera::next(Picture& picture, Moment deadline) {
  while (Clock::now() < deadline) {
    const auto got = port_.read(room_, deadline);
    if (!got || *got == 0) return Got::kNothing;  // a peer that is gone may come again
    const auto whole = assembler_.take({room_.data(), *got});
    if (const auto begun = assembler_.counts().begun; !whole && begun > begun_) {
      begun_ = begun;
      return Got::kPart;
    }
    if (!whole) continue;
    const std::string bytes(whole->jpeg.begin(), whole->jpeg.end());
    files::ImageFile file;
    try {
      file = files::decoded_jpeg(port_.name(), bytes);
    } catch (const std::runtime_error&) {
      continue;  // torn: the next one is on its way
    }
    if (file.stored_width != size_.width || file.stored_height != size_.height)
      throw std::runtime_error(port_.name() + ": pictures of " + std::to_string(file.stored_width) +
                               " x " + std::to_string(file.stored_height) +
                               ", the camera's as stored " + std::to_string(size_.width) + " x " +
                               std::to_string(size_.height) + " (camera.size_px)");
    picture.late = stamps_.late(Clock::now().time_since_epoch(), whole->sim_time);
    picture.pixels.assign(file.bytes.begin(), file.bytes.end());
    picture.file.assign(whole->jpeg.begin(), whole->jpeg.end());
    picture.ending = ".jpg";
    picture.format = file.format;
    picture.stored_width = file.stored_width, picture.stored_height = file.stored_height;
    picture.number = count_++;
    return Got::kPicture;
  }
  return Got::kNothing;
}

}  // namespace gatefly::live
