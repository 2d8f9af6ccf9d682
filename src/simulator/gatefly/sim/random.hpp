// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include <Random123/philox.h>

namespace gatefly::sim {

/// One stream of random numbers with one purpose: hash(seed, name) is its key.
///
/// Counter-based (Random123, Philox 4x32-10), so that one more draw in one stream changes no other
/// stream, and a value can be drawn by position ("pixel 17 of frame 3") in any order.
class Stream {
 public:
  Stream(std::uint64_t seed, std::string_view name) {
    std::uint64_t hash = 0xcbf29ce484222325ull;  // FNV-1a of the name, then of the seed
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
    for (int i = 0; i < 8; ++i) hash = (hash ^ ((seed >> (8 * i)) & 0xff)) * 0x100000001b3ull;
    key_ = {{static_cast<std::uint32_t>(hash), static_cast<std::uint32_t>(hash >> 32)}};
  }

  /// Four random words for a position in the stream.
  [[nodiscard]] std::array<std::uint32_t, 4> words(std::uint32_t a, std::uint32_t b = 0,
                                                   std::uint32_t c = 0) const {
    const auto r = r123::Philox4x32{}({{a, b, c, 0x5eedu}}, key_);
    return {r[0], r[1], r[2], r[3]};
  }

  /// The next number in [0, 1).
  double uniform() {
    const auto w =
        words(static_cast<std::uint32_t>(count_), static_cast<std::uint32_t>(count_ >> 32), 1);
    ++count_;
    return (w[0] + 0x1p32 * (w[1] & 0x1fffff)) * 0x1p-53;
  }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// The next standard normal number (Box-Muller, one of the pair).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(6.283185307179586 * uniform());
  }
  /// Normal, cut at 2.5 σ by drawing again: what a seed may change.
  double normal_cut(double sigma) {
    for (;;) {
      const double z = normal();
      if (std::abs(z) <= 2.5) return sigma * z;
    }
  }

 private:
  r123::Philox4x32::key_type key_{};
  std::uint64_t count_ = 0;
};

}  // namespace gatefly::sim
