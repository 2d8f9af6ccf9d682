// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/video_file.hpp"

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include <sys/socket.h>
#include <unistd.h>

#include "gatefly/files/subprocess.hpp"

namespace gatefly::io {
namespace {

std::vector<std::string> command(int width, int height, int pictures_per_second,
                                 const VideoFormat& format, const std::string& file) {
  std::vector<std::string> words{
      "ffmpeg",       "-nostdin",
      "-hide_banner", "-loglevel",
      "error",        "-y",
      "-f",           "rawvideo",
      "-pix_fmt",     format.pixels,
      "-s",           std::to_string(width) + "x" + std::to_string(height),
      "-r",           std::to_string(pictures_per_second),
      "-i",           "pipe:0"};
  words.insert(words.end(), format.encoder.begin(), format.encoder.end());
  words.push_back("file:" + file);
  return words;
}

}  // namespace

void require_ffmpeg() {
  pid_t pid = -1;
  const int error = start({"ffmpeg", "-version"}, {}, pid);
  if (error != 0 || wait_for(pid) != 0)
    throw std::runtime_error(
        "ffmpeg: " + (error != 0 ? std::string{std::strerror(error)} : "does not run") +
        "; a video needs it (apt-get install ffmpeg)");
}

VideoFormat h264() {
  return {"rgb24",
          {"-vf",
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
           "mp4"}};
}

VideoFile::VideoFile(std::filesystem::path path, int width, int height, int pictures_per_second,
                     const VideoFormat& format)
    : path_{std::move(path)}, partial_{path_.string() + ".partial"}, messages_{std::tmpfile()} {
  // A pair of sockets, because writing to a pipe that ffmpeg has left would end the whole program
  // (SIGPIPE).
  int ends[2] = {-1, -1};
  if (!messages_ || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(errno));
  const int error = start(command(width, height, pictures_per_second, format, partial_.string()),
                          {.input = ends[1], .errors = fileno(messages_.get())}, ffmpeg_);
  ::close(ends[1]);
  pipe_ = ends[0];
  if (error == 0) return;
  ::close(pipe_);
  throw std::runtime_error("ffmpeg: " + std::string{std::strerror(error)} + "; a video needs it");
}

VideoFile::~VideoFile() {
  if (finished_) return;
  if (ffmpeg_ > 0) kill(ffmpeg_, SIGKILL);
  close_and_wait();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void VideoFile::add(const Canvas& picture) { add(picture.rgb()); }

void VideoFile::add(std::span<const std::uint8_t> picture) {
  for (std::span<const std::uint8_t> rest = picture; !rest.empty();) {
    const ssize_t sent = send(pipe_, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) fail();
    rest = rest.subspan(static_cast<std::size_t>(sent));
  }
}

void VideoFile::finish() {
  if (close_and_wait() != 0) fail();
  std::error_code error;
  std::filesystem::rename(partial_, path_, error);
  if (error) throw std::runtime_error(path_.string() + ": cannot be written: " + error.message());
  finished_ = true;
}

/// The end of its input is how ffmpeg knows that the film is over.
int VideoFile::close_and_wait() {
  if (pipe_ >= 0) ::close(std::exchange(pipe_, -1));
  return ffmpeg_ > 0 ? wait_for(std::exchange(ffmpeg_, -1)) : 0;
}

void VideoFile::fail() {
  close_and_wait();
  const std::string why = last_line(messages_.get());
  throw std::runtime_error(path_.string() +
                           ": cannot be written: ffmpeg: " + (why.empty() ? "ended early" : why));
}

}  // namespace gatefly::io
