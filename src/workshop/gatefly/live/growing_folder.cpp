// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/growing_folder.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace gatefly::live {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, int error) {
  throw DiskFailed(path.string() + ": cannot be written: " + std::strerror(error));
}

/// @return 0, or why not all could be written.
int write_all(int file, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t done = ::write(file, bytes, size);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return done < 0 ? errno : ENOSPC;
    bytes += done, size -= static_cast<std::size_t>(done);
  }
  return 0;
}

}  // namespace

GrowingFile::GrowingFile(const fs::path& path)
    : path_{path}, file_{::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644)} {
  if (file_ < 0) fail(path_, errno);
}

GrowingFile::~GrowingFile() { ::close(file_); }

void GrowingFile::add(std::string_view lines) {
  if (const int error = write_all(file_, lines.data(), lines.size()); error != 0) {
    (void)!::ftruncate(file_, size_);  // half a line is none
    (void)::lseek(file_, size_, SEEK_SET);
    fail(path_, error);
  }
  size_ += static_cast<std::int64_t>(lines.size());
}

void GrowingFile::sync() {
  if (::fdatasync(file_) != 0) fail(path_, errno);
}

fs::path next_flight_folder(const fs::path& parent) {
  constexpr int kMost = 9999;
  std::error_code error;
  fs::create_directories(parent, error);
  for (int i = 1; i <= kMost; ++i) {
    std::array<char, 16> name{};
    std::snprintf(name.data(), name.size(), "flight-%04d", i);
    if (fs::create_directory(parent / name.data(), error)) return parent / name.data();
    if (error) throw DiskFailed((parent / name.data()).string() + ": " + error.message());
  }
  throw DiskFailed(parent.string() + ": holds " + std::to_string(kMost) + " flights already");
}

void write_whole(const fs::path& path, std::span<const std::uint8_t> bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) fail(path, errno);
  const int error = write_all(file, reinterpret_cast<const char*>(bytes.data()), bytes.size());
  ::close(file);
  if (error == 0) return;
  ::unlink(path.c_str());
  fail(path, error);
}

void write_whole(const fs::path& path, std::string_view text) {
  write_whole(path, std::span{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void sync_disk_of(const fs::path& folder) {
  const int place = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (place < 0) return;
  (void)::syncfs(place);
  ::close(place);
}

std::uintmax_t free_bytes(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return error ? 0 : space.available;
}

}  // namespace gatefly::live
