// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/picture_color.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace gatefly {
namespace {

constexpr int kLevels = 256;

// Distances between sampled pixels, and between the two of a pair, by the picture's shorter side.
constexpr double kGrid = 1.0 / 16.0, kApart = 1.0 / 50.0;

// [levels; of 5, 7, 9, 11, and pairs 3, 4, 12 px apart of 160: the labelled sets' best, whole and
// spoilt in 24 ways]
constexpr double kContrast = 7.0;
// [nats; thresholds of equal false alarms in whole and in spoilt pictures]
constexpr double kPerDoubling = 0.3;
// A cast up to this is left. [of 0, 3, 5, 8: basement580's floor and walls are
// greenish, other halls stay under their own light with more]
constexpr int kCast = 5;
constexpr int kMostCast = 32;

// Fourths of an octave, in 1/64.
constexpr std::array kGains{64, 76, 91, 108, 128, 152, 181, 215, 256, 304, 362};
constexpr int kGainBits = 6;
static_assert(kGains[0] == 1 << kGainBits);

int gain_of(double times) {
  int gain = 0;
  for (const int more : kGains) gain += more <= times * kGains[0];
  return std::max(0, gain - 1);
}

using Counts = std::array<int, kLevels>;

int median_of(const Counts& counts, int total) {
  int level = 0;
  // At most kLevels times.
  for (int so_far = counts[0]; 2 * so_far < total && level < kLevels - 1;)
    so_far += counts[static_cast<std::size_t>(++level)];
  return level;
}

int neutral_of(const Counts& counts, int total) {
  const int cast = median_of(counts, total) - 128,
            beyond = std::clamp(std::abs(cast) - kCast, 0, kMostCast);
  return 128 + (cast < 0 ? -beyond : beyond);
}

}  // namespace

ChromaTone tone_of(const Image& image, const ColorModel& model) {
  ChromaTone tone;
  if (image.empty()) return tone;
  const int shorter = std::min(image.width(), image.height()),
            grid = std::max(1, static_cast<int>(kGrid * shorter)),
            apart = std::max(1, static_cast<int>(kApart * shorter));
  constexpr int kParts = 4;  // of a level
  Counts us{}, vs{}, contrasts{};
  int pixels = 0, pairs = 0;
  const auto contrast = [&](Yuv a, Yuv b) {
    const float along =
        model.hue[0] * static_cast<float>(a.u - b.u) + model.hue[1] * static_cast<float>(a.v - b.v);
    const int part = std::min(static_cast<int>(kParts * std::abs(along)), kLevels - 1);
    ++contrasts[static_cast<std::size_t>(part)], ++pairs;
  };
  // At most once a row and a column: the grid is a pixel at least.
  for (int v = grid / 2; v < image.height(); v += grid)
    for (int u = grid / 2; u < image.width(); u += grid) {
      const Yuv c = image.at(u, v);
      ++us[c.u], ++vs[c.v], ++pixels;
      if (u + apart < image.width()) contrast(c, image.at(u + apart, v));
      if (v + apart < image.height()) contrast(c, image.at(u, v + apart));
    }
  if (pixels == 0 || pairs == 0) return tone;
  tone.neutral_u = neutral_of(us, pixels), tone.neutral_v = neutral_of(vs, pixels);
  int part = 0;
  // At most kLevels times.
  for (int so_far = contrasts[0]; 10 * so_far < 9 * pairs && part < kLevels - 1;)
    so_far += contrasts[static_cast<std::size_t>(++part)];
  tone.gain = gain_of(kContrast * kParts / (part + 0.5));
  return tone;
}

PictureColor::PictureColor() {
  static const ColorModel kNoColor = [] {
    ColorModel none;
    none.absolute.fill(-ColorModel::kUnit), none.relative.fill(-ColorModel::kUnit);
    none.find_hopeless();
    return none;
  }();
  *this = kNoColor;
}

PictureColor::PictureColor(const ColorModel& model) : model_{&model} { make_tables(); }

void PictureColor::set(const ColorModel& model, const ChromaTone& tone) {
  model_ = &model;
  if (tone == tone_) return;
  tone_ = tone;
  make_tables();
}

void PictureColor::make_tables() {
  constexpr double kFourths = 4.0;
  faintness_ = kPerDoubling * tone_.gain / kFourths;
  const int gain = kGains[static_cast<std::size_t>(tone_.gain)];
  const auto larger = [gain](int difference) {
    return (difference * gain + (1 << (kGainBits - 1))) >> kGainBits;
  };
  const auto toned = [&](int level, int neutral) {
    return std::clamp(128 + larger(level - neutral), 0, kLevels - 1);
  };
  for (int level = 0; level < kLevels; ++level) {
    const auto i = static_cast<std::size_t>(level);
    starts_.u[i] = ColorModel::kStarts.u[static_cast<std::size_t>(toned(level, tone_.neutral_u))];
    starts_.v[i] = ColorModel::kStarts.v[static_cast<std::size_t>(toned(level, tone_.neutral_v))];
    const auto byte = [](int of) { return static_cast<std::uint8_t>(of); };
    constexpr std::uint8_t kNone = 0;
    hopeless_u_[i] = static_cast<std::uint16_t>(
        ColorModel::chroma_bin(PackedYuv::of({0, byte(toned(level, tone_.neutral_u)), kNone})));
    hopeless_v_[i] = static_cast<std::uint16_t>(
        ColorModel::chroma_bin(PackedYuv::of({0, kNone, byte(toned(level, tone_.neutral_v))})));
  }
  for (int step = -255; step <= 255; ++step) {
    const int to = std::clamp(larger(step), -(kLevels - 1), kLevels - 1);
    const auto i = static_cast<std::size_t>(255 + step), from = static_cast<std::size_t>(255 + to);
    starts_.u_step[i] = ColorModel::kStarts.u_step[from];
    starts_.v_step[i] = ColorModel::kStarts.v_step[from];
  }
}

}  // namespace gatefly
