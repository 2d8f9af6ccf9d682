// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/foreign_logs/stamps.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>

namespace gatefly::foreign_logs {
namespace {

/// Digits after the point of so many of these that are nanoseconds.
int decimals_of(std::string_view unit) {
  return unit == "s" ? 9 : unit == "ms" ? 6 : unit == "us" ? 3 : 0;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "1.40e18", as some programs write.
std::optional<std::chrono::nanoseconds> rounded(std::string_view text, int decimals) {
  constexpr double kMost = 9e18;
  double value = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const double ns = value * std::pow(10.0, decimals);
  if (error != std::errc{} || rest != text.data() + text.size() || !(std::abs(ns) < kMost))
    return std::nullopt;
  return std::chrono::nanoseconds{std::llround(ns)};
}

}  // namespace

std::optional<std::chrono::nanoseconds> stamp_in(std::string_view text, std::string_view unit) {
  constexpr std::uint64_t kMost = 9'200'000'000'000'000'000U;
  const int decimals = decimals_of(unit);
  const bool negative = text.starts_with('-');
  const std::string_view digits = negative ? text.substr(1) : text;
  std::uint64_t ns = 0;
  int after = -1;  // digits behind the point so far; -1: before it
  bool any = false;
  for (const char c : digits) {
    if (c == '.' && after < 0) {
      after = 0;
    } else if (is_digit(c)) {
      any = true;
      if (after >= 0 && after++ >= decimals) continue;  // below a nanosecond
      if (ns > (kMost - 9) / 10) return std::nullopt;
      ns = 10 * ns + static_cast<std::uint64_t>(c - '0');
    } else {
      return rounded(text, decimals);
    }
  }
  if (!any) return std::nullopt;
  for (int i = after < 0 ? 0 : after; i < decimals; ++i) {
    if (ns > kMost / 10) return std::nullopt;
    ns *= 10;
  }
  const auto count = static_cast<std::int64_t>(ns);
  return std::chrono::nanoseconds{negative ? -count : count};
}

std::string stamp_of_name(std::string_view name) {
  name = name.substr(0, name.rfind('.'));
  std::size_t end = name.size();
  while (end > 0 && !is_digit(name[end - 1])) --end;
  std::size_t begin = end;
  bool point = false;
  while (begin > 0 && (is_digit(name[begin - 1]) || (name[begin - 1] == '.' && !point))) {
    point = point || name[begin - 1] == '.';
    --begin;
  }
  if (begin < end && name[begin] == '.') ++begin;
  return std::string{name.substr(begin, end - begin)};
}

}  // namespace gatefly::foreign_logs
