// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include "gatefly/files/text.hpp"

namespace gatefly::files {
namespace {

constexpr std::uintmax_t kMostCsvBytes = std::uintmax_t{512} << 20;
constexpr std::ptrdiff_t kMostColumns = 1000;
constexpr std::size_t kMostCells = 80'000'000;  // an hour of a flight's log

/// Takes the part of `rest` before the next `end`; the whole when there is none.
std::string_view take(std::string_view& rest, char end) {
  const std::size_t length = std::min(rest.find(end), rest.size());
  const std::string_view part = rest.substr(0, length);
  rest.remove_prefix(std::min(length + 1, rest.size()));
  return part;
}

/// A cell without the quotes that some programs put around texts.
std::string_view unquoted(std::string_view cell) {
  const bool is_quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
  return is_quoted ? cell.substr(1, cell.size() - 2) : cell;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  const auto count = std::count(line.begin(), line.end(), separator) + 1;
  for (std::ptrdiff_t i = 0; i < count; ++i) cells.push_back(unquoted(take(line, separator)));
  return cells;
}

/// The separator of two names; spreadsheets of half of the world write semicolons.
char separator_of(std::string_view header) {
  for (const char separator : {',', ';', '\t'})
    if (header.find(separator) != std::string_view::npos) return separator;
  return ',';
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

}  // namespace

Csv::Csv(const std::filesystem::path& path) : Csv{path, read_file(path, kMostCsvBytes)} {}

Csv::Csv(const std::filesystem::path& path, std::string content)
    : file_{path.string()}, content_{std::move(content)} {
  std::string_view rest{content_};
  constexpr std::string_view kByteOrderMark{"\xEF\xBB\xBF"};
  if (rest.starts_with(kByteOrderMark)) rest.remove_prefix(kByteOrderMark.size());
  if (rest.starts_with("\xFF\xFE") || rest.starts_with("\xFE\xFF"))
    throw std::runtime_error(file_ + ": is UTF-16 text, must be UTF-8");
  if (rest.find('\0') != std::string_view::npos)
    throw std::runtime_error(file_ + ": is no text, it has bytes of zero");
  // Old spreadsheets end lines by CR alone.
  const char line_end = rest.find('\n') == std::string_view::npos ? '\r' : '\n';
  const auto next_line = [&] {
    std::string_view line = take(rest, line_end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  };
  const std::string_view first = next_line();
  if (first.empty()) throw std::runtime_error(file_ + ":1: must start with a line of column names");
  separator_ = separator_of(first);
  if (std::count(first.begin(), first.end(), separator_) >= kMostColumns)
    throw std::runtime_error(file_ + ":1: has more than " + std::to_string(kMostColumns) +
                             " columns, which no such file has");
  for (const std::string_view name : cells_of(first, separator_))
    header_.emplace_back(unquoted(trimmed(name)));
  if (std::set<std::string>(header_.begin(), header_.end()).size() != header_.size())
    throw std::runtime_error(file_ + ":1: two columns have the same name");

  if (content_.size() > kMostCsvBytes)
    throw std::runtime_error(file_ + ": is longer than " + std::to_string(kMostCsvBytes >> 20) +
                             " MiB, which no such file is");
  while (!rest.empty()) {
    add_row(next_line());
    if (cells_.size() > kMostCells)
      throw std::runtime_error(file_ + ": has more than " + std::to_string(kMostCells) +
                               " cells, which no such file has");
  }
}

void Csv::add_row(std::string_view line) {
  const auto columns =
      static_cast<std::size_t>(std::count(line.begin(), line.end(), separator_)) + 1;
  if (columns != header_.size())
    throw std::runtime_error(place(rows_) + ": has " + std::to_string(columns) +
                             " cells, must have " + std::to_string(header_.size()) +
                             " as the header");
  const auto offset = [&](std::size_t at) {
    return static_cast<std::uint32_t>(static_cast<std::size_t>(line.data() - content_.data()) + at);
  };
  cells_.push_back(offset(0));
  for (std::size_t at = line.find(separator_); at != std::string_view::npos;
       at = line.find(separator_, at + 1))
    cells_.push_back(offset(at + 1));
  cells_.push_back(offset(line.size() + 1));
  ++rows_;
}

std::string_view Csv::cell(std::size_t row, std::size_t column) const {
  const std::uint32_t* const at = &cells_[row * (header_.size() + 1) + column];
  return unquoted(std::string_view{content_}.substr(at[0], at[1] - at[0] - 1));
}

std::string Csv::place(std::size_t row) const { return file_ + ":" + std::to_string(row + 2); }

std::string Csv::place(std::size_t row, const std::string& column) const {
  return place(row) + ":" + std::to_string(index_of(column) + 1);
}

bool Csv::has(const std::string& column) const {
  return std::find(header_.begin(), header_.end(), column) != header_.end();
}

std::size_t Csv::index_of(const std::string& column) const {
  const auto found = std::find(header_.begin(), header_.end(), column);
  if (found == header_.end())
    throw std::runtime_error(file_ + ":1: has no column '" + column +
                             "' (there are: " + one_line(joined(header_), 400) + ")");
  return static_cast<std::size_t>(found - header_.begin());
}

std::vector<double> Csv::numbers(const std::string& column) const {
  const std::size_t index = index_of(column);
  std::vector<double> values(rows_, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t row = 0; row < rows_; ++row) {
    std::string_view text = trimmed(cell(row, index));
    if (text.empty()) continue;
    std::string pointed;  // 0.5 in place of 0,5
    if (separator_ != ',') {
      pointed = text;
      std::replace(pointed.begin(), pointed.end(), ',', '.');
      text = pointed;
    }
    const auto result = std::from_chars(text.data(), text.data() + text.size(), values[row]);
    if (result.ec != std::errc{} || result.ptr != text.data() + text.size() ||
        !std::isfinite(values[row]))
      throw std::runtime_error(place(row) + ":" + std::to_string(index + 1) + ": " + column +
                               " = '" + one_line(std::string{text}, 40) +
                               "', must be a number or nothing");
  }
  return values;
}

std::vector<std::string> Csv::texts(const std::string& column) const {
  const std::size_t index = index_of(column);
  std::vector<std::string> values(rows_);
  for (std::size_t row = 0; row < rows_; ++row) values[row] = cell(row, index);
  return values;
}

}  // namespace gatefly::files
