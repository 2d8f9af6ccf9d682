// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/new_lines.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gatefly::link_sim {
namespace {

constexpr std::size_t kLongest = 4096;  ///< More without an end is no line.

}  // namespace

NewLines::NewLines(const std::string& path)
    : fd_{open(path.c_str(), O_RDONLY | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0644)} {
  struct stat about {};
  if (fd_ < 0 || fstat(fd_, &about) != 0) {
    const std::string why = std::strerror(errno);
    if (fd_ >= 0) close(fd_);
    throw std::runtime_error(path + ": cannot be read: " + why);
  }
  regular_ = S_ISREG(about.st_mode);
  if (regular_) lseek(fd_, 0, SEEK_END);
}

NewLines::~NewLines() { close(fd_); }

void NewLines::begin_anew_if_shorter() {
  struct stat about {};
  if (!regular_ || fstat(fd_, &about) != 0 || about.st_size >= lseek(fd_, 0, SEEK_CUR)) return;
  lseek(fd_, 0, SEEK_SET);
  begun_.clear();
}

std::vector<std::string> NewLines::read() {
  begin_anew_if_shorter();
  std::vector<std::string> lines;
  std::array<char, 1024> room{};
  for (ssize_t got = 0; (got = ::read(fd_, room.data(), room.size())) > 0;)
    for (const char c : std::string_view{room.data(), static_cast<std::size_t>(got)}) {
      if (c == '\n') {
        lines.push_back(begun_);
        begun_.clear();
      } else if (begun_.size() < kLongest) {
        begun_ += c;
      }
    }
  return lines;
}

}  // namespace gatefly::link_sim
