// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// How much a pixel speaks for the gate: two tables of log-likelihood ratios, one over its colour
/// and one over how that differs from the colour around it.
///
/// The second is what makes a washed-out gate stand out from walls of nearly its colour. [ours: the
/// paper tests a box in Y'CbCr.] Tables are fitted to labelled pictures or follow from a
/// description.
struct ColorModel {
  static constexpr std::size_t kLuma = 16, kChroma = 32;  ///< Bins an axis.
  static constexpr std::size_t kBins = kLuma * kChroma * kChroma;
  static constexpr int kUnit = 16;  ///< Table value of one nat; values are within ±4 nats.

  /// Of a colour alone: no bar's, whatever is around. [of 0, 1/2, 1, 2 nats: the labelled sets'
  /// best]
  static constexpr int kHopeless = -kUnit / 2;

  std::array<std::int8_t, kBins> absolute{}, relative{};
  /// Of each chroma_bin(): 1 where it is hopeless with any luma. All 0 is right, but slow;
  /// find_hopeless() fills it.
  std::array<std::uint8_t, 64 * 64> hopeless{};
  void find_hopeless();  ///< To be called when `absolute` has changed.

  /// Bin of a chroma, 4 levels each way, without a table: this is asked of every sample of a
  /// picture.
  [[nodiscard]] static std::size_t chroma_bin(PackedYuv c) {
    // (v / 4) + 64 (u / 4): times 2^22 + 1, u's six bits come to lie above v's. The two bits more
    // of the factor change nothing below 2^32; with them, compilers multiply instead of shifting
    // and adding, which is two instructions less.
    return ((c.uv & 0x00fc00fc) * 0xc0400001u) >> 18;
  }
  /// Bin of a colour: 16 grey levels a luma bin; 4 levels a chroma bin, from 64 to 191.
  [[nodiscard]] static std::size_t bin(Yuv c) {
    return std::size_t{kStarts.luma[c.y]} + kStarts.u[c.u] + kStarts.v[c.v];
  }
  /// Bin of a difference from the surroundings: 12 levels a luma bin, 3 a chroma bin, around zero.
  [[nodiscard]] static std::size_t difference_bin(Yuv c, Yuv around) {
    const auto at = [](const auto& steps, std::ptrdiff_t a, std::ptrdiff_t b) {
      return std::size_t{(steps.data() + 255)[a - b]};
    };
    return at(kStarts.luma_step, c.y, around.y) + at(kStarts.u_step, c.u, around.u) +
           at(kStarts.v_step, c.v, around.v);
  }

  /// From a description alone: the hue of an sRGB colour (0..1), wherever it is more colourful than
  /// grey and than its surroundings. [ours; scales chosen on the authors' labelled pictures]
  [[nodiscard]] static ColorModel described(const std::array<double, 3>& rgb);

  /// Evidence of a pixel, mean of both tables, in 1 / kUnit nats.
  [[nodiscard]] int evidence(Yuv c, Yuv around) const {
    return (absolute[bin(c)] + relative[difference_bin(c, around)]) / 2;
  }

 private:
  // Where a value's bins begin in a table: `levels` values a bin from `zero` on, what is beyond in
  // the outer ones.
  template <std::size_t N>
  [[nodiscard]] static constexpr std::array<std::uint16_t, N> bins(int zero, int levels,
                                                                   std::size_t count,
                                                                   std::size_t size) {
    std::array<std::uint16_t, N> table{};
    for (int i = 0; i < static_cast<int>(N); ++i)
      table[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(
          size * std::min(i < zero ? std::size_t{0} : static_cast<std::size_t>((i - zero) / levels),
                          count - 1));
    return table;
  }
  // In one place, whose address is looked up once.
  struct Starts {
    std::array<std::uint16_t, 256> luma, u, v;
    std::array<std::uint16_t, 511> luma_step, u_step, v_step;
  };
  static const Starts kStarts;
};

inline constexpr ColorModel::Starts ColorModel::kStarts{
    .luma = bins<256>(0, 16, kLuma, kChroma* kChroma),
    .u = bins<256>(64, 4, kChroma, kChroma),
    .v = bins<256>(64, 4, kChroma, 1),
    .luma_step = bins<511>(255 - 96, 12, kLuma, kChroma* kChroma),
    .u_step = bins<511>(255 - 48, 3, kChroma, kChroma),
    .v_step = bins<511>(255 - 48, 3, kChroma, 1)};

}  // namespace gatefly
