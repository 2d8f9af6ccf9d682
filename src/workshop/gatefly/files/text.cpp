// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/text.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <map>
#include <mutex>
#include <new>
#include <set>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "gatefly/files/printed.hpp"

namespace gatefly::files {

namespace fs = std::filesystem;

namespace {
constexpr std::uintmax_t kMostOfAStream = std::uintmax_t{64} << 20;
constexpr std::size_t kLongestWord = 100;  // that somebody may have meant to be another
}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
  word = word.substr(0, kLongestWord);
  const auto best = std::min_element(candidates.begin(), candidates.end(),
                                     [&](const std::string& a, const std::string& b) {
                                       return edit_distance(word, a) < edit_distance(word, b);
                                     });
  return best == candidates.end() ? std::string{} : *best;
}

std::string suggestion(std::string_view word, std::span<const std::string> candidates) {
  if (word.size() > kLongestWord) return "";
  const std::string best = nearest(word, candidates);
  const auto longest = static_cast<int>(std::max(word.size(), best.size()));
  if (best.empty() || edit_distance(word, best) > std::max(2, longest / 2)) return "";
  return ", did you mean '" + best + "'?";
}

bool counts_before(std::string_view a, std::string_view b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto number_at = [&](std::string_view& text) {  // without leading zeros
    std::size_t end = 0;
    while (end < text.size() && is_digit(text[end])) ++end;
    std::string_view digits = text.substr(0, end);
    text.remove_prefix(end);
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    return digits;
  };
  while (!a.empty() && !b.empty()) {
    if (is_digit(a[0]) && is_digit(b[0])) {
      const std::string_view x = number_at(a), y = number_at(b);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[0] != b[0]) return a[0] < b[0];
      a.remove_prefix(1), b.remove_prefix(1);
    }
  }
  return a.size() < b.size();
}

std::string text_of(double value, int digits) {
  if (std::isnan(value)) return "nan";
  std::array<char, 64> buffer{};
  if (digits > 0) {
    const auto rounded = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                       std::chars_format::general, digits);
    std::from_chars(buffer.data(), rounded.ptr, value);
  }
  char* const last = buffer.data() + buffer.size();
  const bool whole = std::abs(value) < 1e15 && value == std::floor(value);  // 1000000, not 1e+06
  const auto end = whole ? std::to_chars(buffer.data(), last, value, std::chars_format::fixed)
                         : std::to_chars(buffer.data(), last, value);
  return {buffer.data(), end.ptr};
}

std::string fixed(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string joined(std::span<const std::string> words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += between;
    text += word;
  }
  return text;
}

std::string one_line(std::string text, std::size_t most) {
  const bool longer = text.size() > most;
  if (longer) text.resize(most);  // not all of what may be megabytes
  text = printable(text);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\t'; }, ' ');
  if (!longer) return text;
  std::size_t end = std::min(text.size(), most - 3);
  while (end > 0 && end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
    --end;
  return text.substr(0, end) + "...";
}

std::string reason_of(const std::exception& error) {
  if (const auto* file = dynamic_cast<const fs::filesystem_error*>(&error))
    return one_line(shortened(file->path1().string(), 240), 300) + ": " + file->code().message();
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return "not enough memory";
  const std::string what = readable(error.what());
  return one_line(what, what.size());
}

std::string read_file(const fs::path& path, std::uintmax_t most) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status))
    throw std::runtime_error(path.string() + ": is a folder, not a file");
  // A pipe gives its content once, a device may never end.
  static std::map<std::string, std::string> pipes;
  static std::mutex guard;
  const bool is_stream = fs::exists(status) && !fs::is_regular_file(status);
  const std::lock_guard lock{guard};
  if (const auto known = pipes.find(path.string()); is_stream && known != pipes.end())
    return known->second;
  if (is_stream) most = std::min(most, kMostOfAStream);

  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + ": cannot be read: " + std::strerror(errno));
  std::string content;
  std::vector<char> piece(1 << 20);
  while (file && content.size() <= most) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    content.append(piece.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad()) throw std::runtime_error(path.string() + ": cannot be read to its end");
  if (content.size() > most)
    throw std::runtime_error(path.string() + ": is longer than " + std::to_string(most >> 20) +
                             " MiB, which no such file is");
  if (is_stream) pipes[path.string()] = content;
  return content;
}

}  // namespace gatefly::files
