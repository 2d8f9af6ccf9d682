// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace gatefly {

/// Eight numbers at once: compilers make what is done to them one instruction (SSE2, NEON).
using Eight = std::int16_t __attribute__((vector_size(16)));
inline constexpr std::size_t kEight = 8;

/// Those from `values` on.
[[nodiscard]] inline Eight eight(const std::int16_t* values) {
  Eight numbers;
  std::memcpy(&numbers, values, sizeof numbers);
  return numbers;
}
/// The same one eight times.
[[nodiscard]] inline Eight eight(std::int16_t value) { return Eight{} + value; }

}  // namespace gatefly
