// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace gatefly::foreign_logs {

/// A moment by its decimal digits, exact to the nanosecond: a double has too few for time since 1970.
/// @param unit  "s", "ms", "us", "ns"
/// @return nullopt when it is no number, or beyond 292 years.
[[nodiscard]] std::optional<std::chrono::nanoseconds> stamp_in(std::string_view text,
                                                               std::string_view unit);

/// The last number in a file's name, before its ending: "left-1403636579.76.png" → "1403636579.76";
/// "" when there is none.
[[nodiscard]] std::string stamp_of_name(std::string_view name);

}  // namespace gatefly::foreign_logs
