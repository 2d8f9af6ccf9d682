// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <string>
#include <string_view>

// Names, arguments and texts of files come from anywhere: what a terminal would obey must not reach
// it, and what nobody reads to its end is not shown whole.

namespace gatefly::files {

/// Whether printable() has nothing to change.
[[nodiscard]] bool is_printable(std::string_view text);

/// `text` with spaces in place of control characters, but line breaks and tabs, and a question mark
/// in place of each byte that is no UTF-8.
[[nodiscard]] std::string printable(std::string_view text);

/// `text` in about `most` bytes: where it is longer, its beginning and its end, which mostly says
/// what is wrong.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t most);

/// A message with no word above 240 and no more than 2000 bytes in all.
[[nodiscard]] std::string readable(std::string_view message);

/// While one lives, standard output and standard error pass on what they get as it is: the content
/// of a file, or a sequence for the terminal that is our own.
class AsItIs {
 public:
  AsItIs() { ++count(); }
  ~AsItIs() { --count(); }
  AsItIs(const AsItIs&) = delete;
  AsItIs& operator=(const AsItIs&) = delete;
  [[nodiscard]] static bool lives() { return count() > 0; }

 private:
  static std::atomic<int>& count();
};

}  // namespace gatefly::files
