// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gatefly::live {

/// A failed write: "out/flight-0003/log_si.csv: No space left on device".
class DiskFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file of lines that grows where it is, for a recorder whose power may go: it never ends within a line that add() did not, and is on the disk
/// soon.
class GrowingFile {
 public:
  /// @throws DiskFailed
  explicit GrowingFile(const std::filesystem::path& path);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// Whole lines. What does not go to the file whole does not go at all. @throws DiskFailed
  void add(std::string_view lines);
  /// Onto the disk itself. @throws DiskFailed
  void sync();

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::int64_t size_ = 0;
};

/// A folder for a flight that is recorded in place: <parent>/flight-0001 and so on, the next one that is not there.
/// @throws DiskFailed
[[nodiscard]] std::filesystem::path next_flight_folder(const std::filesystem::path& parent);

/// A file, whole or not at all. @throws DiskFailed
void write_whole(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
void write_whole(const std::filesystem::path& path, std::string_view text);

/// Everything that was written to the disk of a folder, onto it; takes as long as that takes.
void sync_disk_of(const std::filesystem::path& folder);

/// Bytes that are free where a folder is; 0 when nobody knows.
[[nodiscard]] std::uintmax_t free_bytes(const std::filesystem::path& folder);

}  // namespace gatefly::live
