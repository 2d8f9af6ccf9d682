// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/video_file.hpp"

#include <string>
#include <utility>
#include <vector>

namespace gatefly::drawing {
namespace {

std::vector<std::string> coding() {
  return {"-vf",
          "scale=out_color_matrix=bt709:out_range=tv",
          "-c:v",
          "libx264",
          "-preset",
          "veryfast",
          "-crf",
          "21",
          "-pix_fmt",
          "yuv420p",
          "-colorspace",
          "bt709",
          "-color_primaries",
          "bt709",
          "-color_trc",
          "bt709",
          "-movflags",
          "+faststart",
          "-f",
          "mp4"};
}

}  // namespace

VideoFile::VideoFile(std::filesystem::path path, int width, int height, int pictures_per_second)
    : pipe_{
          std::move(path),
          {.pixels = "rgb24", .width = width, .height = height, .per_second = pictures_per_second},
          coding()} {}

void VideoFile::add(const Canvas& picture) { pipe_.add(picture.rgb()); }

void VideoFile::finish() { pipe_.finish(); }

}  // namespace gatefly::drawing
