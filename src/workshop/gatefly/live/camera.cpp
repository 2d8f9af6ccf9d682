// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/camera.hpp"

#include "gatefly/live/folder_camera.hpp"
#include "gatefly/live/slice_camera.hpp"
#include "gatefly/live/stream_camera.hpp"

namespace gatefly::live {

std::unique_ptr<Camera> opened(const CameraUri& uri, StoredSize size, bool paced) {
  switch (uri.kind) {
    case CameraUri::Kind::kFolder:
      return std::make_unique<FolderCamera>(uri.place, size, paced);
    case CameraUri::Kind::kSlices:
      return std::make_unique<SliceCamera>(Port::udp(uri.bind, uri.port, uri.peer), size);
    case CameraUri::Kind::kStream:
      break;
  }
  return std::make_unique<StreamCamera>(uri.place, size);
}

}  // namespace gatefly::live
