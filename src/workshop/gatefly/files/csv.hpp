// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gatefly::files {

/// A table of text cells with a header line; every cell's place is known for error messages.
class Csv {
 public:
  /// Reads cells between commas; between semicolons or tabs where the header has no comma, and then
  /// 0,5 is a number. Every line as wide as the header, quotes only around whole cells, one trailing
  /// newline (or CR LF) and a byte-order mark allowed. At most 512 MiB and 80 million cells.
  /// @throws std::runtime_error "file:line: what is wrong".
  explicit Csv(const std::filesystem::path& path);
  /// Reads content that is already known.
  Csv(const std::filesystem::path& path, std::string content);

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] const std::vector<std::string>& header() const { return header_; }
  [[nodiscard]] bool has(const std::string& column) const;

  /// A column of numbers, with blanks around them or without; an empty cell is NaN.
  /// @throws std::runtime_error "file:line:column: ..." for anything else, or when there is no such
  ///         column, listing those there are.
  [[nodiscard]] std::vector<double> numbers(const std::string& column) const;
  /// A column as it is written.
  [[nodiscard]] std::vector<std::string> texts(const std::string& column) const;
  /// The file's line of a row, as an editor counts, with the file's name: "log_si.csv:12".
  [[nodiscard]] std::string place(std::size_t row) const;
  /// With the column, counted from 1: "log_si.csv:12:3".
  [[nodiscard]] std::string place(std::size_t row, const std::string& column) const;

 private:
  [[nodiscard]] std::size_t index_of(const std::string& column) const;
  void add_row(std::string_view line);
  [[nodiscard]] std::string_view cell(std::size_t row, std::size_t column) const;

  std::string file_, content_;
  std::vector<std::string> header_;
  /// First byte of each cell in content_, and one beyond the row's end: a log has millions.
  std::vector<std::uint32_t> cells_;
  std::size_t rows_ = 0;
  char separator_ = ',';

 public:
  Csv(const Csv&) = delete;  // cells_ point into content_
  Csv& operator=(const Csv&) = delete;
};

}  // namespace gatefly::files
