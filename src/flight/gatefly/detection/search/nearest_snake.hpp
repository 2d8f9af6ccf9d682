// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

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

inline constexpr std::size_t kMostSnakes = 3 * kEight;  ///< Followed at once.
inline constexpr int kMostSnakeReach = 512;             ///< Beyond it no snake is assigned.

/// The snake expected nearest to x of those that reach it, the first of several; kMostSnakes where
/// none does. Asked at every crossing of a bar: eight at a time, 5 % of the fast search. The same in
/// plain words: tests/detection/nearest_snake_test.cpp.
/// @param reach  how far off a snake may be expected, kMostSnakeReach at most; 0: not at all.
[[nodiscard]] inline std::size_t nearest_snake(
    const std::array<std::int16_t, kMostSnakes>& expected,
    const std::array<std::int16_t, kMostSnakes>& reach, std::int16_t x) {
  // How far off and which one in one number: the least is the nearest.
  constexpr int kBits = 5;
  constexpr std::int16_t kFar = std::numeric_limits<std::int16_t>::max();
  static_assert(kMostSnakes < 1 << kBits);
  static_assert(kMostSnakeReach << kBits < kFar);
  const Eight at = eight(x), none{}, far = eight(kFar);
  Eight which{0, 1, 2, 3, 4, 5, 6, 7}, least = far;
  for (std::size_t k = 0; k < kMostSnakes; k += kEight, which += kEight) {
    const Eight to = at - eight(expected.data() + k), off = to < none ? -to : to;
    const Eight key = off < eight(reach.data() + k) ? (off << kBits) + which : far;
    least = key < least ? key : least;
  }
  std::int16_t nearest = least[0];
  for (std::size_t k = 1; k < kEight; ++k) nearest = std::min<std::int16_t>(nearest, least[k]);
  return nearest == kFar ? kMostSnakes : static_cast<std::size_t>(nearest & ((1 << kBits) - 1));
}

}  // namespace gatefly
