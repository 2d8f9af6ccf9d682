// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "gatefly/flight_log/recording.hpp"
#include "gatefly/live/camera.hpp"

namespace gatefly::live {

/// The pictures of a recorded flight, in their order.
class FolderCamera : public Camera {
 public:
  FolderCamera(const std::filesystem::path& folder, StoredSize size, bool paced);
  Got next(Picture& picture, Moment deadline) override;

 private:
  flight_log::FlightFolder folder_;
  flight_log::PictureSource source_;
  bool paced_;
  Moment start_;
  std::size_t next_ = 0;
};

}  // namespace gatefly::live
