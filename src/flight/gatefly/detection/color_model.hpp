// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

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
  /// Levels a bin of a colour: luma from 0 on, chroma around grey.
  static constexpr int kLumaLevels = 16, kChromaLevels = 4;
  static constexpr int kFirstChroma = 128 - kChromaLevels * static_cast<int>(kChroma) / 2;
  /// Levels a bin of a difference, around zero.
  static constexpr int kLumaStep = 12, kChromaStep = 3;
  static constexpr int kFirstLumaStep = -kLumaStep * static_cast<int>(kLuma) / 2,
                       kFirstChromaStep = -kChromaStep * static_cast<int>(kChroma) / 2;
  static constexpr int kUnit = 16;     ///< Table value of one nat.
  static constexpr int kMostNats = 4;  ///< Table values are within.
  static_assert(kUnit * kMostNats <= std::numeric_limits<std::int8_t>::max());

  /// Evidence below which a colour is no bar's in any surroundings. [of 0, 1/2, 1, 2 nats: the
  /// labelled sets' best]
  static constexpr int kHopeless = -kUnit / 2;

  static constexpr int kChromaBits = 6;  ///< Bits kept of a chroma in a chroma_bin().
  static_assert(kChromaLevels << kChromaBits == 256);

  std::array<std::int8_t, kBins> absolute{}, relative{};
  /// Flag of each chroma_bin(): 1 where it is hopeless with any luma. All 0 is right, but slow;
  /// find_hopeless() fills it.
  std::array<std::uint8_t, std::size_t{1} << (2 * kChromaBits)> hopeless{};
  /// Direction of the gate's chroma from grey, (u, v), length 1.
  std::array<float, 2> hue{0.0f, 1.0f};
  /// To be called when `absolute` has changed: finds what follows from it.
  void find_hopeless();

  /// Bin of a chroma alone, 64 (u / 4) + v / 4. Asked of every sample of a picture: multiplied in
  /// place of shifted and added, 6 % fewer instructions of the fast search.
  [[nodiscard]] static std::size_t chroma_bin(PackedYuv c) {
    constexpr int kPlaceOfV = 16 + 8 - kChromaBits;  // and where the bin ends up
    constexpr std::uint32_t kKept = 256 - kChromaLevels, kKeptOfBoth = kKept << 16 | kKept;
    // Times 2^22 + 1, what is kept of u comes to lie above what is kept of v.
    constexpr std::uint32_t kAboveV = std::uint32_t{1} << (16 + kChromaBits) | 1;
    // Changes nothing below 2^32. Without it compilers shift and add again.
    constexpr std::uint32_t kNeverShifted = std::uint32_t{3} << 30;
    return ((c.uv & kKeptOfBoth) * (kAboveV | kNeverShifted)) >> kPlaceOfV;
  }
  /// Bin of a colour; from tables: dividing, the fast search takes 20 % longer.
  [[nodiscard]] static std::size_t bin(Yuv c) {
    return std::size_t{kStarts.luma[c.y]} + kStarts.u[c.u] + kStarts.v[c.v];
  }
  /// Bin of a difference from the surroundings.
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

  /// Start of each value's bin in a table; one object, so that its address is looked up once.
  struct Starts {
    std::array<std::uint16_t, 256> luma, u, v;
    std::array<std::uint16_t, 511> luma_step, u_step, v_step;
  };
  static const Starts kStarts;

 private:
  // First table entry of a value's bin: `levels` values a bin from `zero` on, values beyond in
  // the outer ones; `size` entries a bin.
  template <std::size_t N>
  [[nodiscard]] static constexpr std::array<std::uint16_t, N> bins(int zero, int levels,
                                                                   std::size_t count,
                                                                   std::size_t size) {
    static_assert(kBins - 1 <= std::numeric_limits<std::uint16_t>::max());
    std::array<std::uint16_t, N> table{};
    for (int i = 0; i < static_cast<int>(N); ++i)
      table[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(
          size * std::min(i < zero ? std::size_t{0} : static_cast<std::size_t>((i - zero) / levels),
                          count - 1));
    return table;
  }
};

inline constexpr ColorModel::Starts ColorModel::kStarts{
    .luma = bins<256>(0, kLumaLevels, kLuma, kChroma* kChroma),
    .u = bins<256>(kFirstChroma, kChromaLevels, kChroma, kChroma),
    .v = bins<256>(kFirstChroma, kChromaLevels, kChroma, 1),
    .luma_step = bins<511>(255 + kFirstLumaStep, kLumaStep, kLuma, kChroma* kChroma),
    .u_step = bins<511>(255 + kFirstChromaStep, kChromaStep, kChroma, kChroma),
    .v_step = bins<511>(255 + kFirstChromaStep, kChromaStep, kChroma, 1)};

}  // namespace gatefly
