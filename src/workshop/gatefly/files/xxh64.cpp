// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/xxh64.hpp"

#include <charconv>
#include <cstddef>

#define XXH_INLINE_ALL  // the header alone: nothing to link, on no processor
#include <xxhash.h>

namespace gatefly::files {

std::uint64_t xxh64(std::span<const std::uint8_t> bytes) {
  return XXH64(bytes.data(), bytes.size(), 0);
}

std::string text_of_xxh64(std::uint64_t hash) {
  std::string text(16, '0');
  for (std::size_t i = 0; i < 16; ++i) text[15 - i] = "0123456789abcdef"[hash >> (4 * i) & 15U];
  return text;
}

std::optional<std::uint64_t> xxh64_of_text(std::string_view text) {
  std::uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  if (text.size() != 16 || error != std::errc{} || end != text.data() + text.size())
    return std::nullopt;
  return hash;
}

}  // namespace gatefly::files
