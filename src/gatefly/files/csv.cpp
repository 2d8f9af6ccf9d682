// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "gatefly/files/text.hpp"

namespace gatefly::io {
namespace {

/// Takes the part of `rest` before the next `end`; the whole when there is none.
std::string_view take(std::string_view& rest, char end) {
  const std::size_t length = std::min(rest.find(end), rest.size());
  const std::string_view part = rest.substr(0, length);
  rest.remove_prefix(std::min(length + 1, rest.size()));
  return part;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  const auto count = std::count(line.begin(), line.end(), ',') + 1;
  for (std::ptrdiff_t i = 0; i < count; ++i) cells.push_back(take(line, ','));
  return cells;
}

}  // namespace

Csv::Csv(const std::filesystem::path& path) : file_{path.string()}, content_{read_file(path)} {
  std::string_view rest{content_};
  const auto next_line = [&] {
    std::string_view line = take(rest, '\n');
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  };
  const std::string_view first = next_line();
  if (first.empty()) throw std::runtime_error(file_ + ":1: must start with a line of column names");
  for (const std::string_view name : cells_of(first)) header_.emplace_back(name);
  if (std::set<std::string>(header_.begin(), header_.end()).size() != header_.size())
    throw std::runtime_error(file_ + ":1: two columns have the same name");

  while (!rest.empty()) {
    const auto cells = cells_of(next_line());
    if (cells.size() != header_.size())
      throw std::runtime_error(place(rows_) + ": has " + std::to_string(cells.size()) +
                               " cells, must have " + std::to_string(header_.size()) +
                               " as the header");
    cells_.insert(cells_.end(), cells.begin(), cells.end());
    ++rows_;
  }
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
    throw std::runtime_error(file_ + ":1: has no column '" + column + "'" +
                             suggestion(column, header_));
  return static_cast<std::size_t>(found - header_.begin());
}

std::vector<double> Csv::numbers(const std::string& column) const {
  const std::size_t index = index_of(column);
  std::vector<double> values(rows_, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t row = 0; row < rows_; ++row) {
    const std::string_view text = cell(row, index);
    if (text.empty()) continue;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), values[row]);
    if (result.ec != std::errc{} || result.ptr != text.data() + text.size() ||
        !std::isfinite(values[row]))
      throw std::runtime_error(place(row) + ":" + std::to_string(index + 1) + ": " + column +
                               " = '" + std::string{text.substr(0, 40)} +
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

}  // namespace gatefly::io
