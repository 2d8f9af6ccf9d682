// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/video_reader.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "gatefly/files/subprocess.hpp"

namespace gatefly::io {
namespace {

// What holds pictures; without this list ffmpeg paints text files and follows playlists to other
// files.
constexpr const char* kContainers =
    "avi,mov,matroska,mpegts,mpeg,mpegvideo,m4v,mjpeg,h264,hevc,av1,obu,ivf,ogg,flv,asf,gif,apng,"
    "yuv4mpegpipe,nut,mxf,"
    "dv,rm,bmp_pipe,tiff_pipe,webp_pipe";

std::vector<std::string> decoder(const std::string& file, bool as_stored) {
  std::vector<std::string> words{
      "ffmpeg",      "-nostdin",     "-hide_banner",
      "-loglevel",   "error",        "-format_whitelist",
      kContainers,   "-i",           "file:" + file,
      "-map",        "0:v:0",        "-fps_mode",
      "passthrough", "-vf",          "scale=out_range=full:out_color_matrix=bt601,format=yuv444p",
      "-f",          "yuv4mpegpipe", "pipe:1"};
  if (as_stored) words.insert(words.begin() + 1, "-noautorotate");
  return words;
}

/// Planes one after the other become Y, Cb, Cr of each pixel.
std::vector<std::uint8_t> interleaved(const std::vector<std::uint8_t>& planes) {
  std::vector<std::uint8_t> pixels(planes.size());
  const std::size_t count = planes.size() / 3;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t channel = 0; channel < 3; ++channel)
      pixels[3 * i + channel] = planes[channel * count + i];
  return pixels;
}

}  // namespace

VideoReader::VideoReader(std::filesystem::path path, bool as_stored)
    : path_{std::move(path)}, messages_{std::tmpfile()} {
  if (!std::ifstream(path_))
    throw std::runtime_error(path_.string() + ": cannot be read: " + std::strerror(errno));
  int ends[2] = {-1, -1};
  if (!messages_ || pipe2(ends, O_CLOEXEC) != 0)
    throw std::runtime_error(path_.string() + ": cannot be read: " + std::strerror(errno));
  const int error = start(decoder(path_.string(), as_stored),
                          {.output = ends[1], .errors = fileno(messages_.get())}, ffmpeg_);
  ::close(ends[1]);
  stream_.reset(fdopen(ends[0], "rb"));
  if (error != 0)
    throw std::runtime_error(path_.string() +
                             ": no picture, and to read it as a video ffmpeg is needed: " +
                             std::strerror(error) + " (apt-get install ffmpeg)");
}

VideoReader::~VideoReader() {
  if (ffmpeg_ <= 0) return;
  kill(ffmpeg_, SIGKILL);
  wait_for(ffmpeg_);
}

bool VideoReader::read_line(std::string& line) {
  line.clear();
  for (int c = std::fgetc(stream_.get()); c != EOF; c = std::fgetc(stream_.get())) {
    if (c == '\n') return true;
    line += static_cast<char>(c);
  }
  return false;
}

std::optional<ImageFile> VideoReader::next() {
  std::string line;
  if (width_ == 0 && read_line(line)) {  // "YUV4MPEG2 W160 H312 F25:1 C444 ..."
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      if (word[0] == 'W') width_ = std::atoi(word.c_str() + 1);
      if (word[0] == 'H') height_ = std::atoi(word.c_str() + 1);
    }
  }
  const std::size_t size = image_bytes(PixelFormat::kYuv444, width_, height_);
  std::vector<std::uint8_t> planes(size);
  if (size == 0 || !read_line(line) || std::fread(planes.data(), 1, size, stream_.get()) != size) {
    end();
    return std::nullopt;
  }
  ++pictures_;
  return ImageFile{.bytes = interleaved(planes),
                   .format = PixelFormat::kYuv444,
                   .stored_width = width_,
                   .stored_height = height_};
}

/// Says what was wrong, if anything was.
void VideoReader::end() {
  if (ffmpeg_ <= 0) return;
  const int status = wait_for(std::exchange(ffmpeg_, -1));
  std::string why = last_line(messages_.get());
  if (status == 0 && why.empty() && pictures_ > 0) return;
  const std::string prefix = "file:" + path_.string() + ": ";
  if (why.starts_with(prefix)) why.erase(0, prefix.size());
  if (why.starts_with('[') && why.find("] ") != std::string::npos)
    why.erase(0, why.find("] ") + 2);  // "[mjpeg @ 0x5617...] ": where in its memory
  if (why.empty()) why = "it holds no picture";
  throw std::runtime_error(path_.string() + ": " +
                           (pictures_ == 0
                                ? "neither a picture nor a video"
                                : "damaged, after " + std::to_string(pictures_) + " pictures") +
                           " (ffmpeg: " + why + ")");
}

}  // namespace gatefly::io
