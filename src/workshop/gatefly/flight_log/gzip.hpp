// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>

namespace gatefly::flight_log {

/// A file.gz written piece by piece, the same bytes for the same content.
class GzipFile {
 public:
  GzipFile();
  ~GzipFile();
  GzipFile(const GzipFile&) = delete;
  GzipFile& operator=(const GzipFile&) = delete;

  void open(const std::filesystem::path& path);
  void write(std::string_view piece);
  void close();
  [[nodiscard]] bool good() const { return file_.good(); }

 private:
  void deflate(std::string_view piece, bool last);
  struct Stream;
  std::unique_ptr<Stream> stream_;
  std::ofstream file_;
};

/// Content of a file.gz: all of its members, one after the other.
///
/// What is packed more than 32 times as tight as itself is no log: numbers that were measured are
/// not.
/// @param most  unpacked bytes: what is longer is no such file.
/// @throws std::runtime_error one line: unreadable, no gzip file, cut off, damaged, too long.
[[nodiscard]] std::string read_gzip(const std::filesystem::path& path,
                                    std::size_t most = std::size_t{512} << 20);

}  // namespace gatefly::flight_log
