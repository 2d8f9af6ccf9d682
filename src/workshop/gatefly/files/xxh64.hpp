// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gatefly::files {

/// XXH64 of some bytes, seed 0: tells two pictures apart, not a forger from an honest man.
///
/// By the xxHash library. About 10 GB/s: nothing beside rendering a picture.
[[nodiscard]] std::uint64_t xxh64(std::span<const std::uint8_t> bytes);

/// 16 hexadecimal digits, as `xxhsum -H1` prints it.
[[nodiscard]] std::string text_of_xxh64(std::uint64_t hash);
/// nullopt when it is no such text.
[[nodiscard]] std::optional<std::uint64_t> xxh64_of_text(std::string_view text);

}  // namespace gatefly::files
