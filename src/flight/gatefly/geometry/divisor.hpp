// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace gatefly {

/// Division by a number that stays the same for many: a multiplication. A Cortex-A9 has no instruction
/// for dividing whole numbers, and calls a function each time. [ours]
class Divisor {
 public:
  /// @param by  1 or more
  explicit constexpr Divisor(int by)
      : reciprocal_{((std::uint64_t{1} << 32) + static_cast<unsigned>(by) - 1) /
                    static_cast<unsigned>(by)} {}

  /// Quotient, rounded down. The reciprocal is too large by less than 2^-32: exact where dividend times
  /// divisor is below 2^32. @param dividend  0 or more
  [[nodiscard]] constexpr int operator()(int dividend) const {
    return static_cast<int>((static_cast<unsigned>(dividend) * reciprocal_) >> 32);
  }

 private:
  std::uint64_t reciprocal_;  ///< 2^32 / by, rounded up.
};

}  // namespace gatefly
