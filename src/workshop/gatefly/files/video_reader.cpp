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

namespace gatefly::files {
namespace {

// Containers of pictures; without this list ffmpeg paints text files and follows playlists to other
// files.
constexpr const char* kContainers =
    "avi,mov,matroska,mpegts,mpeg,mpegvideo,m4v,mjpeg,h264,hevc,av1,obu,ivf,ogg,flv,asf,gif,apng,"
    "yuv4mpegpipe,nut,mxf,"
    "dv,rm,bmp_pipe,tiff_pipe,webp_pipe";

std::vector<std::string> decoder(const std::string& file, VideoReader::As as) {
  const bool uyvy = as == VideoReader::As::kUyvy;
  std::vector<std::string> words{
      "ffmpeg",
      "-nostdin",
      "-hide_banner",
      "-loglevel",
      "error",
      "-format_whitelist",
      kContainers,
      "-i",
      "file:" + file,
      "-map",
      "0:v:0",
      "-fps_mode",
      "passthrough",
      "-vf",
      uyvy ? "format=yuv422p" : "scale=out_range=full:out_color_matrix=bt601,format=yuv444p",
      "-f",
      "yuv4mpegpipe",
      "pipe:1"};
  if (as != VideoReader::As::kUpright) words.insert(words.begin() + 1, "-noautorotate");
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

/// Planes Y, Cb, Cr, of which the last two have every second column, become U Y0 V Y1.
std::vector<std::uint8_t> interleaved_uyvy(const std::vector<std::uint8_t>& planes) {
  std::vector<std::uint8_t> pixels(planes.size());
  const std::uint8_t* y = planes.data();
  const std::uint8_t* u = y + planes.size() / 2;
  const std::uint8_t* v = u + planes.size() / 4;
  for (std::uint8_t* to = pixels.data(); to < pixels.data() + pixels.size(); to += 4) {
    to[0] = *u++, to[1] = *y++;
    to[2] = *v++, to[3] = *y++;
  }
  return pixels;
}

}  // namespace

VideoReader::VideoReader(std::filesystem::path path, As as)
    : path_{std::move(path)}, as_{as}, messages_{std::tmpfile()} {
  if (!std::ifstream(path_))
    throw std::runtime_error(path_.string() + ": cannot be read: " + std::strerror(errno));
  int ends[2] = {-1, -1};
  if (!messages_ || pipe2(ends, O_CLOEXEC) != 0)
    throw std::runtime_error(path_.string() + ": cannot be read: " + std::strerror(errno));
  const int error = start(decoder(path_.string(), as_),
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
  const bool uyvy = as_ == As::kUyvy;
  if (uyvy && width_ % 2 != 0)
    throw std::runtime_error(path_.string() + ": its pictures are " + std::to_string(width_) +
                             " wide, must be even");
  const PixelFormat format = uyvy ? PixelFormat::kUyvy : PixelFormat::kYuv444;
  const std::size_t size = image_bytes(format, width_, height_);
  std::vector<std::uint8_t> planes(size);
  if (size == 0 || !read_line(line) || std::fread(planes.data(), 1, size, stream_.get()) != size) {
    end();
    return std::nullopt;
  }
  ++pictures_;
  return ImageFile{.bytes = uyvy ? interleaved_uyvy(planes) : interleaved(planes),
                   .format = format,
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

}  // namespace gatefly::files
