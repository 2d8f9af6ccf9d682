// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/files/film_pipe.hpp"

namespace gatefly::drawing {

/// A film written picture by picture: H.264 in MP4 (yuv420p, BT.709) as browsers play it, by ffmpeg
/// at the other end of a pipe. It is whole or not there, as FilmPipe says.
class VideoFile {
 public:
  /// @param width,height  of every picture, even [px]
  /// @throws std::runtime_error when ffmpeg cannot be started.
  VideoFile(std::filesystem::path path, int width, int height, int pictures_per_second);

  /// The next picture. @throws std::runtime_error with ffmpeg's own words when it has given up.
  void add(const Canvas& picture);
  void add(std::span<const std::uint8_t> picture);
  /// Waits until the film is whole, then names it. @throws std::runtime_error as add().
  void finish();

 private:
  files::FilmPipe pipe_;
};

}  // namespace gatefly::drawing
