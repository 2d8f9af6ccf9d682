// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <sys/types.h>

#include "gatefly/files/image_file.hpp"

namespace gatefly::files {

/// A film read picture by picture, decoded by ffmpeg at the other end of a pipe.
///
/// Pictures come as full-range JFIF Y'CbCr without a way round by RGB where the film's matrix
/// allows it (MJPEG and everything BT.601); luma is then the film's own to the bit. No picture is
/// dropped or doubled.
class VideoReader {
 public:
  enum class As {
    kUpright,  ///< Turned as the film itself says.
    kStored,   ///< Not turned.
    kUyvy,     ///< Not turned, 4:2:2 as our own lossless films have it, to the bit.
  };
  /// @throws std::runtime_error one line: the file cannot be read, or there is no ffmpeg.
  explicit VideoReader(std::filesystem::path path, As as = As::kUpright);
  ~VideoReader();
  VideoReader(const VideoReader&) = delete;
  VideoReader& operator=(const VideoReader&) = delete;

  /// The next picture; nullopt after the last.
  /// @throws std::runtime_error with ffmpeg's own words: no video at all, or damaged (after what
  ///     could be read).
  [[nodiscard]] std::optional<ImageFile> next();

 private:
  [[nodiscard]] bool read_line(std::string& line);
  void end();

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  As as_;
  std::unique_ptr<std::FILE, Close> messages_;  ///< ffmpeg's words; a file without a name.
  std::unique_ptr<std::FILE, Close> stream_;    ///< YUV4MPEG2: a line of sizes, then planes.
  pid_t ffmpeg_ = -1;
  int width_ = 0, height_ = 0, pictures_ = 0;
};

}  // namespace gatefly::files
