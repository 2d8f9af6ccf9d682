// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/color_model.hpp"

#include <cmath>

namespace gatefly {
namespace {

// Evidence of a chroma `along` the hue and `across` it: from `zero` on it speaks for the gate, a
// nat more with every `scale`; what is off the hue by more than `slack` counts against it.
struct Slope {
  double zero, scale, off_hue, slack;
};
constexpr Slope kAbsolute{8.0, 6.0, 1.2, 4.0}, kRelative{3.0, 4.0, 0.8, 2.0};
constexpr double kMostNats = 3.0;  // of a description
// Bins of luma in which a sensor is nearly full: what tint is left there is the lens' or the
// sensor's.
constexpr std::size_t kBurntOut = 14;
constexpr std::int8_t kOfBurntOut = -2 * ColorModel::kUnit;
static_assert(kMostNats <= ColorModel::kMostNats);

std::int8_t evidence_of(const Slope& slope, double along, double across) {
  const double off = std::max(0.0, std::abs(across) - 0.35 * std::max(0.0, along) - slope.slack);
  const double nats = (along - slope.zero - slope.off_hue * off) / slope.scale;
  return static_cast<std::int8_t>(
      std::lround(ColorModel::kUnit * std::clamp(nats, -kMostNats, kMostNats)));
}

}  // namespace

ColorModel ColorModel::described(const std::array<double, 3>& rgb) {
  const auto byte = [](double c) {
    return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(c, 0.0, 1.0)));
  };
  const Yuv color = yuv_of_rgb(byte(rgb[0]), byte(rgb[1]), byte(rgb[2]));
  const double u = color.u - 128, v = color.v - 128,
               chroma = std::max(1.0, std::sqrt(u * u + v * v));
  const double hue_u = u / chroma, hue_v = v / chroma;
  ColorModel model;
  std::size_t i = 0;
  for (std::size_t y = 0; y < kLuma; ++y)
    for (int bu = 0; bu < static_cast<int>(kChroma); ++bu)
      for (int bv = 0; bv < static_cast<int>(kChroma); ++bv, ++i) {
        // The middle of the bin, of a colour and of a difference.
        const auto fill = [&](std::array<std::int8_t, kBins>& table, const Slope& slope, double du,
                              double dv) {
          table[i] = evidence_of(slope, du * hue_u + dv * hue_v, du * hue_v - dv * hue_u);
        };
        const auto middle_of_color = [](int bin) {
          return kFirstChroma - 128 + kChromaLevels * bin + 0.5 * (kChromaLevels - 1);
        };
        const auto middle_of_difference = [](int bin) {
          return kFirstChromaStep + kChromaStep * bin + 0.5 * (kChromaStep - 1);
        };
        fill(model.absolute, kAbsolute, middle_of_color(bu), middle_of_color(bv));
        if (y >= kBurntOut) model.absolute[i] = std::min(model.absolute[i], kOfBurntOut);
        fill(model.relative, kRelative, middle_of_difference(bu), middle_of_difference(bv));
      }
  model.find_hopeless();
  return model;
}

void ColorModel::find_hopeless() {
  const auto byte = [](int level) { return static_cast<std::uint8_t>(level); };
  for (int u = 0; u < 256; u += kChromaLevels)
    for (int v = 0; v < 256; v += kChromaLevels) {
      bool all = true;
      for (int y = 0; y < 256; y += kLumaLevels)
        all = all && absolute[bin({byte(y), byte(u), byte(v)})] < kHopeless;
      hopeless[chroma_bin(PackedYuv::of({0, byte(u), byte(v)}))] = all;
    }
  // The middle of what speaks for the gate, from grey on.
  double sum_u = 0.0, sum_v = 0.0;
  std::size_t i = 0;
  for (std::size_t y = 0; y < kLuma; ++y)
    for (int u = 0; u < static_cast<int>(kChroma); ++u)
      for (int v = 0; v < static_cast<int>(kChroma); ++v, ++i) {
        const int weight = std::max<int>(0, absolute[i]);
        const int middle = static_cast<int>(kChroma) / 2;
        sum_u += weight * (u - middle + 0.5), sum_v += weight * (v - middle + 0.5);
      }
  const double length = std::sqrt(sum_u * sum_u + sum_v * sum_v);
  if (length > 0.0) hue = {static_cast<float>(sum_u / length), static_cast<float>(sum_v / length)};
}

}  // namespace gatefly
