// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "gatefly/live/clock.hpp"
#include "gatefly/live/picture.hpp"
#include "gatefly/live/uri.hpp"

namespace gatefly::live {

/// A source of pictures. Only the camera's thread calls it.
class Camera {
 public:
  /// kPart: something of a new picture, which is not whole yet and may never be.
  enum class Got { kPicture, kPart, kNothing, kEnded };
  virtual ~Camera() = default;
  /// Puts the next picture into `picture`, waiting for it until `deadline`; kEnded: none will come any more.
  /// @throws std::runtime_error one line, when a picture cannot be used.
  virtual Got next(Picture& picture, Moment deadline) = 0;
  /// Why it ended; "" when it just has no more.
  [[nodiscard]] virtual std::string why() const { return ""; }
};

/// Size of the pictures that the camera's file describes [px], as stored.
struct StoredSize {
  int width = 0, height = 0;
};

/// @param paced  pictures of a folder come at their own pace; else as fast as they are taken.
/// @throws std::runtime_error one line: no such folder, port, program.
[[nodiscard]] std::unique_ptr<Camera> opened(const CameraUri& uri, StoredSize size, bool paced);

}  // namespace gatefly::live
