// SPDX-License-Identifier: Apache-2.0
#include "gatefly/io/video_file.hpp"

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace gatefly::io {
namespace {

/// Starts a program of PATH with these files as stdin and stderr (-1: none), in a process group of its
/// own: Ctrl-C is for us to handle. Answers errno, 0 when it runs.
int start(std::vector<std::string> words, int input, int errors, pid_t& pid) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  const auto connect = [&](int from, int to) {
    if (from >= 0) posix_spawn_file_actions_adddup2(&files, from, to);
    else posix_spawn_file_actions_addopen(&files, to, "/dev/null", O_RDWR, 0);
  };
  connect(input, STDIN_FILENO);
  connect(-1, STDOUT_FILENO);
  connect(errors, STDERR_FILENO);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error = posix_spawnp(&pid, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return error;
}

/// 0 when the program ended well.
int wait_for(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return status;
}

/// The last line of an open file that says something.
std::string last_line(std::FILE* file) {
  std::rewind(file);
  std::string line, last;
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
    if (c != '\n') line += static_cast<char>(c);
    else if (!line.empty()) last = std::exchange(line, {});
  }
  return line.empty() ? last : line;
}

std::vector<std::string> encoder(int width, int height, int pictures_per_second, const std::string& file) {
  return {"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-y",
          "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", std::to_string(width) + "x" + std::to_string(height),
          "-r", std::to_string(pictures_per_second), "-i", "pipe:0",
          "-vf", "scale=out_color_matrix=bt709:out_range=tv", "-c:v", "libx264", "-preset", "veryfast", "-crf", "21",
          "-pix_fmt", "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709",
          "-movflags", "+faststart", "-f", "mp4", "file:" + file};
}

}  // namespace

void require_ffmpeg() {
  pid_t pid = -1;
  const int error = start({"ffmpeg", "-version"}, -1, -1, pid);
  if (error != 0 || wait_for(pid) != 0)
    throw std::runtime_error("ffmpeg: " + (error != 0 ? std::string{std::strerror(error)} : "does not run") +
                             "; a video needs it (apt-get install ffmpeg)");
}

VideoFile::VideoFile(std::filesystem::path path, int width, int height, int pictures_per_second)
    : path_{std::move(path)}, partial_{path_.string() + ".partial"}, messages_{std::tmpfile()} {
  // A pair of sockets, because writing to a pipe that ffmpeg has left would end the whole program (SIGPIPE).
  int ends[2] = {-1, -1};
  if (!messages_ || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(errno));
  const int error = start(encoder(width, height, pictures_per_second, partial_.string()), ends[1],
                          fileno(messages_.get()), ffmpeg_);
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

void VideoFile::add(const Canvas& picture) {
  const std::vector<std::uint8_t> bytes = picture.rgb();
  for (std::span<const std::uint8_t> rest{bytes}; !rest.empty();) {
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
  throw std::runtime_error(path_.string() + ": cannot be written: ffmpeg: " + (why.empty() ? "ended early" : why));
}

}  // namespace gatefly::io
