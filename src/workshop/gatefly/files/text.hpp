// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gatefly::files {

/// Letters to insert, remove or replace to get from one word to the other.
[[nodiscard]] int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word`; empty when there is none.
[[nodiscard]] std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// ", did you mean 'x'?" when a candidate is near enough to be meant, else "".
[[nodiscard]] std::string suggestion(std::string_view word,
                                     std::span<const std::string> candidates);

/// Order of names as people count: "img_9" before "img_10".
[[nodiscard]] bool counts_before(std::string_view a, std::string_view b);

/// The shortest text that reads back as the same number; `digits` > 0 rounds to that many first.
[[nodiscard]] std::string text_of(double value, int digits = 0);

/// `value` with so many digits after the point; "-" for NaN and infinity.
[[nodiscard]] std::string fixed(double value, int digits);

/// "a, b, c".
[[nodiscard]] std::string joined(std::span<const std::string> words,
                                 std::string_view between = ", ");

/// "1 picture", "2 pictures".
template <class Whole>
[[nodiscard]] std::string amount(Whole count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

/// `text` on one line, cut after about `most` bytes: control characters become spaces, whole UTF-8
/// letters stay.
[[nodiscard]] std::string one_line(std::string text, std::size_t most = 60);

/// Reason of an error, on one line, in plain words.
[[nodiscard]] std::string reason_of(const std::exception& error);

/// All bytes of a file; of a pipe, the same again when it is read again.
/// @param most  bytes: what is longer is no such file; of a pipe or device 64 MiB at most.
/// @throws std::runtime_error naming it and why it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path,
                                    std::uintmax_t most = std::uintmax_t{1} << 30);

}  // namespace gatefly::files
