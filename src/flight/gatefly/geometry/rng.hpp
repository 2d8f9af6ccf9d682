// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace gatefly {

/// A small generator for flight code: SplitMix64. Same seed, same numbers, on every machine.
///
/// The simulator has its own, counter-based ones (sim/random.hpp); streams are never shared.
class Rng {
 public:
  explicit Rng(std::uint64_t seed = 1) : state_{seed} {}

  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }

  /// A whole number in [0, count); 0 when count <= 0.
  int uniform_index(int count) {
    if (count <= 0) return 0;
    return static_cast<int>(((next() >> 32) * static_cast<std::uint64_t>(count)) >> 32);
  }

  /// A real number in [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(next() >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

}  // namespace gatefly
