// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace gatefly {

/// A time stamp in seconds: the number nearest to it.
[[nodiscard]] constexpr double seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace gatefly
