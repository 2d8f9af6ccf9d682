// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/film_pipe.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <sys/socket.h>
#include <unistd.h>

#include "gatefly/files/subprocess.hpp"

namespace gatefly::files {

void require_ffmpeg_for(const std::string& what) {
  pid_t pid = -1;
  const int error = start({"ffmpeg", "-version"}, {}, pid);
  if (error != 0 || wait_for(pid) != 0)
    throw std::runtime_error(
        "ffmpeg: " + (error != 0 ? std::string{std::strerror(error)} : "does not run") + "; " +
        what + " needs it (apt-get install ffmpeg)");
}

void require_ffmpeg() { require_ffmpeg_for("a video"); }

FilmPipe::FilmPipe(std::filesystem::path path, const Pictures& pictures,
                   const std::vector<std::string>& coding)
    : path_{std::move(path)}, partial_{path_.string() + ".partial"}, messages_{std::tmpfile()} {
  // A pair of sockets, because writing to a pipe that ffmpeg has left would end the whole program
  // (SIGPIPE).
  int ends[2] = {-1, -1};
  if (!messages_ || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(errno));
  std::vector<std::string> words{"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-y"};
  const auto add_words = [&](const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
  };
  add_words({"-f", "rawvideo", "-pix_fmt", pictures.pixels});
  add_words(pictures.colors);
  add_words({"-s", std::to_string(pictures.width) + "x" + std::to_string(pictures.height), "-r",
             std::to_string(pictures.per_second), "-i", "pipe:0"});
  add_words(coding);
  words.push_back("file:" + partial_.string());
  const int error = start(words, {.input = ends[1], .errors = fileno(messages_.get())}, ffmpeg_);
  ::close(ends[1]);
  pipe_ = ends[0];
  if (error == 0) return;
  ::close(pipe_);
  throw std::runtime_error("ffmpeg: " + std::string{std::strerror(error)} + "; a video needs it");
}

FilmPipe::~FilmPipe() {
  if (finished_) return;
  if (ffmpeg_ > 0) kill(ffmpeg_, SIGKILL);
  close_and_wait();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void FilmPipe::add(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = send(pipe_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) fail();
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
}

void FilmPipe::finish() {
  if (close_and_wait() != 0) fail();
  std::error_code error;
  std::filesystem::rename(partial_, path_, error);
  if (error) throw std::runtime_error(path_.string() + ": cannot be written: " + error.message());
  finished_ = true;
}

/// The end of its input is how ffmpeg knows that the film is over.
int FilmPipe::close_and_wait() {
  if (pipe_ >= 0) ::close(std::exchange(pipe_, -1));
  return ffmpeg_ > 0 ? wait_for(std::exchange(ffmpeg_, -1)) : 0;
}

void FilmPipe::fail() {
  close_and_wait();
  const std::string why = last_line(messages_.get());
  throw std::runtime_error(path_.string() +
                           ": cannot be written: ffmpeg: " + (why.empty() ? "ended early" : why));
}

}  // namespace gatefly::files
