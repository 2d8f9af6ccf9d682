// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/toml_file.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <toml++/toml.h>

#include "gatefly/files/text.hpp"

namespace gatefly::files {
namespace {

using nlohmann::json;

using Lines = std::map<std::string, unsigned>;

constexpr std::uintmax_t kMostTomlBytes = std::uintmax_t{1} << 20;
constexpr int kDeepest = 16;
constexpr std::size_t kLongestKey = 100;  // ours have 30 letters at most

/// Lines are for messages: of tables and of their keys, as long and deep as ours are.
void keep_line(const toml::node& node, const std::string& pointer, Lines& lines) {
  constexpr std::size_t kLongest = 200;
  if (pointer.size() <= kLongest) lines[pointer] = node.source().begin.line;
}

json json_of(const toml::node& node, const std::string& pointer, Lines& lines) {
  if (const auto* table = node.as_table()) {
    json object = json::object();
    for (const auto& [key, value] : *table) {
      const std::string name{key.str()}, place = pointer + "/" + name.substr(0, kLongestKey);
      keep_line(value, place, lines);
      object[name] = json_of(value, place, lines);
    }
    return object;
  }
  if (const auto* array = node.as_array()) {
    json list = json::array();
    for (const auto& value : *array) {
      const std::string place = pointer + "/" + std::to_string(list.size());
      if (value.is_table()) keep_line(value, place, lines);
      list.push_back(json_of(value, place, lines));
    }
    return list;
  }
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* whole = node.as_integer()) return whole->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* truth = node.as_boolean()) return truth->get();
  std::ostringstream date;
  node.visit([&](const auto& value) {
    if constexpr (toml::is_date<decltype(value)> || toml::is_time<decltype(value)> ||
                  toml::is_date_time<decltype(value)>)
      date << value.get();
  });
  return date.str();
}

/// Looks for tables and lists in one another in TOML that nobody has parsed yet: the parser calls
/// itself for each level, and the system ends a program that does so too often.
class Nesting {
 public:
  /// The line where it is deeper than kDeepest; 0 when it never is.
  static std::size_t too_deep(std::string_view text) {
    Nesting here{text};
    while (!here.text_.empty())
      if (here.step(); here.brackets_ > kDeepest || here.dots_ > kDeepest) return here.line_;
    return 0;
  }

 private:
  explicit Nesting(std::string_view text) : text_{text} {}

  void step() {
    const char c = text_.front();
    if (c == '"' || c == '\'') return skip_text(c);
    if (c == '#') return skip(std::min(text_.find('\n'), text_.size()));
    if (c == '[' || c == '{') ++brackets_;
    if ((c == ']' || c == '}') && brackets_ > 0) --brackets_;
    if (c == '.') ++dots_;  // of a key: a.b.c
    if (std::string_view{",=[]{}\n"}.find(c) != std::string_view::npos) dots_ = 0;
    skip(1);
  }
  /// "text", 'text', """text""", '''text'''; the last two over several lines.
  void skip_text(char quote) {
    const std::string three(3, quote);
    const bool is_long = text_.starts_with(three);
    skip(is_long ? 3 : 1);
    while (!text_.empty()) {
      if (text_.front() == '\\' && quote == '"')
        skip(2);
      else if (is_long ? text_.starts_with(three) : text_.front() == quote)
        break;
      else if (!is_long && text_.front() == '\n')
        return;  // not closed
      else
        skip(1);
    }
    skip(is_long ? 3 : 1);
    for (int i = 0; is_long && i < 2 && text_.starts_with(quote); ++i) skip(1);  // """""" has two
  }
  void skip(std::size_t count) {
    const std::string_view part = text_.substr(0, count);
    line_ += static_cast<std::size_t>(std::count(part.begin(), part.end(), '\n'));
    text_.remove_prefix(part.size());
  }

  std::string_view text_;
  std::size_t line_ = 1;
  int brackets_ = 0, dots_ = 0;
};

std::string range_text(double low, double high) {
  return "a number in " + text_of(low) + ".." + text_of(high);
}

}  // namespace

TomlFile::TomlFile(const std::filesystem::path& path)
    : TomlFile{path, read_file(path, kMostTomlBytes)} {}

TomlFile::TomlFile(const std::filesystem::path& path, std::string_view content)
    : name_{path.string()} {
  if (const std::size_t line = Nesting::too_deep(content); line > 0)
    throw std::runtime_error(path.string() + ":" + std::to_string(line) + ": is nested more than " +
                             std::to_string(kDeepest) + " levels deep, which no such file is");
  try {
    content_ = json_of(toml::parse(content, path.string()), "", lines_);
  } catch (const toml::parse_error& error) {
    std::string what{error.description()};
    std::replace(what.begin(), what.end(), '\n', ' ');
    throw std::runtime_error(path.string() + ":" + std::to_string(error.source().begin.line) +
                             ": not valid TOML: " + what);
  }
}

std::string TomlFile::place(std::string pointer) const {
  while (!pointer.empty() && !lines_.contains(pointer)) pointer.resize(pointer.rfind('/'));
  return pointer.empty() ? name_ : name_ + ":" + std::to_string(lines_.at(pointer));
}

json parse_toml_value(std::string_view text) {
  if (Nesting::too_deep(text) > 0) return std::string{text};
  try {
    const toml::table table = toml::parse("value = " + std::string{text});
    Lines lines;
    if (table.size() == 1) return json_of(*table.get("value"), "", lines);
  } catch (const toml::parse_error&) {
    // Not TOML: a bare word.
  }
  return std::string{text};
}

Table::Table(const TomlFile& file, std::string pointer, std::string before)
    : file_{file},
      value_{file.content().at(json::json_pointer{pointer})},
      pointer_{std::move(pointer)},
      before_{std::move(before)} {}

Table Table::table(const std::string& key) {
  if (!raw(key).is_object()) fail(key, "a table");
  return {file_, pointer_ + "/" + key, before_ + key + "."};
}

Table Table::item(const std::string& key, std::size_t index, const std::string& name) {
  const std::string pointer = pointer_ + "/" + key + "/" + std::to_string(index);
  const json& value = raw(key).at(index);
  if (!value.is_object())
    throw std::runtime_error(file_.place(pointer) + ": " + name + " = " + shown(value) +
                             ", must be a table");
  return {file_, pointer, name + ": "};
}

std::string Table::place_and_name(const std::string& key) const {
  return file_.place(pointer_ + "/" + key) + ": " + before_ + one_line(key);
}

void Table::fail(const std::string& key, const std::string& what) const {
  const bool there = value_.contains(key);
  throw std::runtime_error(
      place_and_name(key) +
      (there ? " = " + shown(value_.at(key)) + ", must be " : " is missing, must be ") + what);
}

const json& Table::raw(const std::string& key) {
  static const json nothing;
  known_.push_back(key);
  return value_.contains(key) ? value_.at(key) : nothing;
}

bool Table::has(const std::string& key) { return !raw(key).is_null(); }

double Table::checked(const std::string& key, const json& value, double low, double high) const {
  if (!value.is_number()) fail(key, range_text(low, high));
  const double number = value.get<double>();
  if (!(number >= low && number <= high)) fail(key, "in " + text_of(low) + ".." + text_of(high));
  return number;
}

double Table::number(const std::string& key, double low, double high) {
  return checked(key, raw(key), low, high);
}

double Table::number(const std::string& key, double low, double high, double fallback) {
  return has(key) ? checked(key, raw(key), low, high) : fallback;
}

int Table::integer(const std::string& key, int low, int high, int fallback) {
  const json& value = raw(key);
  if (value.is_null()) return fallback;
  const std::string range = std::to_string(low) + ".." + std::to_string(high);
  if (!value.is_number_integer()) fail(key, "a whole number in " + range);
  return static_cast<int>(checked(key, value, low, high));
}

std::vector<double> Table::numbers(const std::string& key, std::size_t count, double low,
                                   double high) {
  const json& value = raw(key);
  const std::string what =
      std::to_string(count) + " numbers in " + text_of(low) + ".." + text_of(high);
  if (!value.is_array() || value.size() != count) fail(key, what);
  std::vector<double> list;
  for (const json& part : value) {
    if (!part.is_number()) fail(key, what);
    const double number = part.get<double>();
    if (!(number >= low && number <= high)) fail(key, what);
    list.push_back(number);
  }
  return list;
}

std::string Table::text(const std::string& key, const std::string& fallback) {
  const json& value = raw(key);
  if (value.is_null()) return fallback;
  if (!value.is_string()) fail(key, "text");
  return value.get<std::string>();
}

void Table::refuse_others() const {
  for (const auto& [key, value] : value_.items())
    if (std::find(known_.begin(), known_.end(), key) == known_.end())
      throw std::runtime_error(place_and_name(key) + " is not a known key" +
                               suggestion(key, known_));
}

}  // namespace gatefly::files
