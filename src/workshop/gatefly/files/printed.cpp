// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/printed.hpp"

#include <algorithm>

namespace gatefly::files {
namespace {

constexpr std::string_view kBetween = " ... ";

bool goes_on(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; }

/// Bytes of the UTF-8 letter that `text` begins with; 0 when it begins with none.
std::size_t letter_size(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x80) return 1;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < size) return 0;
  return std::all_of(text.begin() + 1, text.begin() + static_cast<std::ptrdiff_t>(size), goes_on)
             ? size
             : 0;
}

/// True for control letters of ASCII and of Latin-1's upper half, which UTF-8 has as two bytes.
bool is_control(std::string_view letter) {
  const auto first = static_cast<unsigned char>(letter[0]);
  if (letter.size() == 1) return (first < 0x20 && first != '\n' && first != '\t') || first == 0x7F;
  return first == 0xC2 && static_cast<unsigned char>(letter[1]) < 0xA0;
}

}  // namespace

bool is_printable(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = letter_size(text);
    if (size == 0 || is_control(text.substr(0, size))) return false;
    text.remove_prefix(size);
  }
  return true;
}

std::string printable(std::string_view text) {
  std::string clean;
  clean.reserve(text.size());
  while (!text.empty()) {
    const std::size_t size = letter_size(text);
    if (size == 0)
      clean += '?';
    else if (is_control(text.substr(0, size)))
      clean += ' ';
    else
      clean += text.substr(0, size);
    text.remove_prefix(std::max<std::size_t>(1, size));
  }
  return clean;
}

std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string{text};
  const std::size_t half = (most - std::min(most, kBetween.size())) / 2;
  std::size_t end = half, begin = text.size() - half;
  while (end > 0 && goes_on(text[end])) --end;
  while (begin < text.size() && goes_on(text[begin])) ++begin;
  return std::string{text.substr(0, end)}.append(kBetween).append(text.substr(begin));
}

std::string readable(std::string_view message) {
  constexpr std::size_t kWord = 240, kAll = 2000;
  std::string text;
  while (!message.empty()) {
    const std::size_t end = std::min(message.find(' ') + 1, message.size());
    const std::size_t size = end == 0 ? message.size() : end;  // its blank with it
    text += shortened(message.substr(0, size), kWord);
    message.remove_prefix(size);
  }
  return shortened(text, kAll);
}

std::atomic<int>& AsItIs::count() {
  static std::atomic<int> count{0};
  return count;
}

}  // namespace gatefly::files
