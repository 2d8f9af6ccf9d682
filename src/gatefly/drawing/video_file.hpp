// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

#include "gatefly/drawing/canvas.hpp"

namespace gatefly::io {

/// Whether there is an ffmpeg that can be called. @throws std::runtime_error one line, when there
/// is none.
void require_ffmpeg();

/// How a film is encoded.
struct VideoFormat {
  std::string pixels;                ///< Of the pictures, in ffmpeg's words.
  std::vector<std::string> encoder;  ///< What is said to ffmpeg between its input and the file.
};
/// H.264 in MP4 (yuv420p, BT.709) as browsers play it.
[[nodiscard]] VideoFormat h264();

/// A film written picture by picture, by ffmpeg at the other end of a pipe.
///
/// It grows under `<path>.partial`; finish() gives it its name, the destructor removes what is not
/// whole.
class VideoFile {
 public:
  /// @param width,height  of every picture, even [px]
  /// @throws std::runtime_error when ffmpeg cannot be started.
  VideoFile(std::filesystem::path path, int width, int height, int pictures_per_second,
            const VideoFormat& format = h264());
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  /// The next picture. @throws std::runtime_error with ffmpeg's own words when it has given up.
  void add(const Canvas& picture);
  void add(std::span<const std::uint8_t> picture);
  /// Waits until the film is whole, then names it. @throws std::runtime_error as add().
  void finish();

 private:
  int close_and_wait();
  [[noreturn]] void fail();

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_, partial_;
  std::unique_ptr<std::FILE, Close> messages_;  ///< What ffmpeg says; a file without a name.
  int pipe_ = -1;
  pid_t ffmpeg_ = -1;
  bool finished_ = false;
};

}  // namespace gatefly::io
