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

namespace gatefly::files {

/// Whether there is an ffmpeg that can be called. @throws std::runtime_error one line, when there
/// is none, with what needs it.
void require_ffmpeg_for(const std::string& what);
void require_ffmpeg();  ///< For "a video".

/// Raw pictures into a film, by ffmpeg at the other end of a pipe.
///
/// The film grows under `<path>.partial`; finish() gives it its name, the destructor removes what is
/// not whole.
class FilmPipe {
 public:
  struct Pictures {
    std::string pixels;  ///< As ffmpeg calls them: "rgb24".
    int width = 0, height = 0;
    int per_second = 25;
    std::vector<std::string> colors = {};  ///< Flags that say what the colours mean.
  };
  /// @param coding  what ffmpeg is told between its input and its output.
  /// @throws std::runtime_error when ffmpeg cannot be started.
  FilmPipe(std::filesystem::path path, const Pictures& pictures,
           const std::vector<std::string>& coding);
  ~FilmPipe();
  FilmPipe(const FilmPipe&) = delete;
  FilmPipe& operator=(const FilmPipe&) = delete;

  /// The next picture's bytes. @throws std::runtime_error with ffmpeg's own words when it has given
  ///     up.
  void add(std::span<const std::uint8_t> bytes);
  /// Waits until the film is whole, then names it. @throws std::runtime_error as add().
  void finish();

 private:
  int close_and_wait();
  [[noreturn]] void fail();

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_, partial_;
  std::unique_ptr<std::FILE, Close> messages_;  ///< ffmpeg's words; a file without a name.
  int pipe_ = -1;
  pid_t ffmpeg_ = -1;
  bool finished_ = false;
};

}  // namespace gatefly::files
