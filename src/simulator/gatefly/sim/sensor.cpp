// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace gatefly::sim {
namespace {

// The meter takes the mean of Y, bright places cut so that showcases do not turn the room black.
// Uncut, the means of the real pictures are 124-142 in the showroom, 94-123 in the hall.
constexpr double kTargetMean = 117.0;
constexpr float kMeterCap = 165.0f;
constexpr double kSensitivity = 250.0;  // signal per radiance and second of exposure at gain 1
constexpr double kShortestExposure = 5e-4, kMaxGain = 4.0;
constexpr double kLag = 0.4;                               // of the auto-exposure [s]
constexpr float kFullWell = 12000.0f, kReadNoise = 12.0f;  // [electrons]
// Whites of the real pictures lie near 235, blacks near 66. Blacks are purple, Cb 138 and Cr 130;
// at Y 100 nothing is left of that.
constexpr Float4 kPurple{2.4f, -4.0f, 14.4f, 0.0f};
constexpr float kBlack = 66.0f, kToe = 0.004f;
constexpr Float4 kFull{1.30f, 0.91f, 0.85f, 0.0f};  // where a channel clips: lamps come out pink
constexpr Float4 kTint{0.56f, 1.0f, 0.90f, 0.0f};   // grey comes out cyan
// Colour matrix, by columns; its rows sum to 1.
constexpr Float4 kOfRed{1.75f, -0.45f, 0.02f, 0.0f}, kOfGreen{-0.60f, 1.65f, -0.14f, 0.0f},
    kOfBlue{-0.15f, -0.20f, 1.12f, 0.0f};
constexpr float kBrightest = 25.0f;  // signal beyond which a lamp adds no more glare
// Bloom: what is clipped leaks over a few pixels. Glare: all light leaks a little over the picture.
constexpr float kBloomShare = 0.05f, kBloomKeep = 0.62f;
constexpr int kGlareCell = 8;  // stored pixels
constexpr float kGlareShare = 0.05f, kGlareKeep = 0.55f;
std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

float luma(Float4 c) { return 0.299f * c[0] + 0.587f * c[1] + 0.114f * c[2]; }
Float4 lesser(Float4 a, Float4 b) { return a < b ? a : b; }
Float4 greater(Float4 a, Float4 b) { return a > b ? a : b; }

/// Square roots, rounded as IEEE wants: the same everywhere.
Float4 root(Float4 x) {
#ifdef __SSE__
  return _mm_sqrt_ps(x);
#else
  return Float4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
#endif
}

/// A soft round kernel: a recursive filter to and fro along both axes.
void spread(std::vector<Float4>& picture, int width, int height, float keep) {
  const auto columns = static_cast<std::size_t>(width), lines = static_cast<std::size_t>(height);
  for (std::size_t y = 0; y < lines; ++y) {
    Float4* line = picture.data() + y * columns;
    for (std::size_t x = 1; x < columns; ++x) line[x] += keep * (line[x - 1] - line[x]);
    for (std::size_t x = columns - 1; x-- > 0;) line[x] += keep * (line[x + 1] - line[x]);
  }
  const auto mix = [&](std::size_t y, std::size_t from) {
    Float4* line = picture.data() + y * columns;
    const Float4* other = picture.data() + from * columns;
    for (std::size_t x = 0; x < columns; ++x) line[x] += keep * (other[x] - line[x]);
  };
  for (std::size_t y = 1; y < lines; ++y) mix(y, y - 1);
  for (std::size_t y = lines - 1; y-- > 0;) mix(y, y + 1);
}

std::uint8_t byte(float x) { return static_cast<std::uint8_t>(std::clamp(x, 0.0f, 255.0f) + 0.5f); }

}  // namespace

Sensor::Sensor(const world::CameraTruth& camera, const world::LightConditions& light,
               std::uint64_t seed)
    : width_{camera.stored_width},
      height_{camera.stored_height},
      glare_width_{(width_ + kGlareCell - 1) / kGlareCell + 2},
      glare_height_{(height_ + kGlareCell - 1) / kGlareCell + 2},
      longest_exposure_{camera.exposure},
      // An amount of light, as a photographer's exposure is; grey levels go with its 1/2.2th power.
      target_{
          std::clamp(kBlack + (kTargetMean - kBlack) * std::pow(light.exposure_target, 1.0 / 2.2),
                     kBlack + 8.0, kMeterCap - 8.0)},
      noise_scale_{light.noise_scale},
      saturation_{static_cast<float>(camera.imaging.saturation)},
      red_shift_{static_cast<float>(camera.imaging.red_shift_px)},
      chroma_smoothing_{camera.imaging.chroma_smoothing},
      fast_{camera.fast},
      seed_{mixed(seed + 0x9E3779B97F4A7C15ull)},
      exposure_{camera.exposure} {
  const auto& balance = light.white_balance;
  const Float4 wb{static_cast<float>(balance[0]), static_cast<float>(balance[1]),
                  static_cast<float>(balance[2]), 0};
  tint_ = kTint * wb;
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  vignette_.resize(pixels);
  const double half_diagonal2 = 0.25 * (width_ * width_ + height_ * height_);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const double dx = x - 0.5 * (width_ - 1), dy = y - 0.5 * (height_ - 1);
      vignette_[static_cast<std::size_t>(y * width_ + x)] =
          static_cast<float>(1.0 - 0.35 * (dx * dx + dy * dy) / half_diagonal2);
    }
  }
  line_.resize(static_cast<std::size_t>(2 * width_));
  glare_.resize(static_cast<std::size_t>(glare_width_ * glare_height_));
  scratch_.resize(pixels);
  // A square root with a toe; IEEE square roots are the same everywhere.
  const float toe = std::sqrt(kToe), top = std::sqrt(1.0f + kToe);
  for (std::size_t i = 0; i < tone_.size(); ++i) {
    const float x = static_cast<float>(i) / static_cast<float>(tone_.size() - 1);
    tone_[i] = (std::sqrt(x + kToe) - toe) / (top - toe);
  }
}

inline Float4 Sensor::developed(Float4 signal) const {
  const Float4 raw = lesser(signal, kFull);
  const Float4 balanced = (raw[0] * kOfRed + raw[1] * kOfGreen + raw[2] * kOfBlue) * tint_;
  const Float4 entry = greater(lesser(balanced, Float4{1, 1, 1, 1}), Float4{}) * 4096.0f + 0.5f;
  const auto tone = [&](float x) { return tone_[static_cast<std::size_t>(x)]; };
  const Float4 level{tone(entry[0]), tone(entry[1]), tone(entry[2]), 0.0f};
  const Float4 dark = (1.0f - level) * (1.0f - level);
  return kBlack + (255.0f - kBlack) * level + dark * dark * dark * kPurple;
}

void Sensor::set_exposure(double brightness) {
  // A long exposure first, then gain; in bright light a shorter exposure.
  const double wanted = brightness / kSensitivity;
  exposure_ = std::clamp(wanted, std::min(kShortestExposure, longest_exposure_), longest_exposure_);
  gain_ = std::clamp(wanted / exposure_, 1e-3, kMaxGain);
  brightness_ = exposure_ * gain_ * kSensitivity;
}

void Sensor::meter(std::span<const Float4> radiances) {
  if (radiances.empty()) return;
  double low = 1e-3, high = 1e3;
  for (int step = 0; step < 30; ++step) {
    const double middle = std::sqrt(low * high);
    double sum = 0.0;
    for (const Float4& radiance : radiances) {
      // 0.8: the vignette's mean.
      sum += static_cast<double>(
          std::min(luma(developed(0.8f * static_cast<float>(middle) * radiance)), kMeterCap));
    }
    (sum < target_ * static_cast<double>(radiances.size()) ? low : high) = middle;
  }
  set_exposure(low);
}

void Sensor::displace_red(std::vector<Float4>& picture) const {
  // Upright up is along a stored line: towards greater x.
  const float share = std::abs(red_shift_);
  const auto width = static_cast<std::size_t>(width_);
  const auto shift = [&](Float4& here, const Float4& source) {
    here[0] += share * (source[0] - here[0]);
  };
  for (std::size_t y = 0; y < static_cast<std::size_t>(height_); ++y) {
    Float4* line = picture.data() + y * width;
    if (red_shift_ > 0.0f)
      for (std::size_t x = width - 1; x > 0; --x) shift(line[x], line[x - 1]);
    else
      for (std::size_t x = 0; x + 1 < width; ++x) shift(line[x], line[x + 1]);
  }
}

void Sensor::bloom(std::vector<Float4>& picture) {
  for (std::size_t i = 0; i < picture.size(); ++i)
    scratch_[i] = greater(picture[i] - 1.0f, Float4{}) * kBloomShare;
  spread(scratch_, width_, height_, kBloomKeep);
  for (std::size_t i = 0; i < picture.size(); ++i) picture[i] += scratch_[i];
}

void Sensor::gather_glare(const std::vector<Float4>& picture) {
  std::fill(glare_.begin(), glare_.end(), Float4{});
  const auto row = static_cast<std::size_t>(glare_width_);
  for (int y = 0; y < height_; ++y) {
    Float4* cells = glare_.data() + static_cast<std::size_t>(y / kGlareCell + 1) * row + 1;
    const Float4* line =
        picture.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (int x = 0; x < width_; ++x) cells[x / kGlareCell] += line[x];
  }
  spread(glare_, glare_width_, glare_height_, kGlareKeep);
  for (Float4& cell : glare_) cell *= kGlareShare / (kGlareCell * kGlareCell);
}

inline Float4 Sensor::glare(int x, int y) const {
  constexpr float kScale = 1.0f / kGlareCell;
  const float u = (static_cast<float>(x) + 0.5f) * kScale + 0.5f,
              v = (static_cast<float>(y) + 0.5f) * kScale + 0.5f;
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const Float4* cell = glare_.data() + j * glare_width_ + i;
  const Float4 top = cell[0] + (u - static_cast<float>(i)) * (cell[1] - cell[0]);
  const Float4 low = cell[glare_width_] +
                     (u - static_cast<float>(i)) * (cell[glare_width_ + 1] - cell[glare_width_]);
  return top + (v - static_cast<float>(j)) * (low - top);
}

inline Float4 Sensor::noise(std::uint32_t frame, std::uint32_t pixel) const {
  // Three sums of three 7-bit numbers: near enough to normal, variance 4096 - 1/4.
  static_assert(3 * 3 * 7 <= std::numeric_limits<std::uint64_t>::digits);
  const std::uint64_t z =
      mixed(seed_ + (static_cast<std::uint64_t>(frame) << 32 | pixel) * 0x9E3779B97F4A7C15ull);
  const auto sum = [z](int shift) {
    return static_cast<float>((z >> shift & 127) + (z >> (shift + 7) & 127) +
                              (z >> (shift + 14) & 127)) -
           190.5f;
  };
  return Float4{sum(0), sum(21), sum(42), 0.0f} * (1.0f / 64.0f);
}

void Sensor::smooth_chroma() {
  // Across stored lines, each with the unsmoothed one above it kept aside.
  const auto width = static_cast<std::size_t>(width_ / 2),
             height = static_cast<std::size_t>(height_);
  std::copy_n(chroma_.begin(), width, line_.begin());
  for (std::size_t y = 0; y < height; ++y) {
    Float4* line = chroma_.data() + y * width;
    const Float4* below = y + 1 < height ? line + width : line;
    for (std::size_t x = 0; x < width; ++x) {
      const Float4 here = line[x];
      line[x] = 0.25f * (line_[x] + below[x]) + 0.5f * here;
      line_[x] = here;
    }
  }
}

void Sensor::adapt(double t, double mean) {
  const double dt = running_ ? std::clamp(t - last_t_, 0.0, 1.0) : 0.0;
  last_t_ = t;
  running_ = true;
  // Levels above black go with the root of the light.
  const double ratio = (target_ - kBlack) / std::max(mean - kBlack, 4.0);
  set_exposure(brightness_ * (1.0 + dt / (dt + kLag) * std::clamp(ratio * ratio - 1.0, -0.7, 2.0)));
}

void Sensor::develop(std::uint32_t frame, double t, std::vector<Float4>& picture,
                     std::vector<std::uint8_t>& uyvy) {
  const float scale = static_cast<float>(brightness_);
  for (Float4& pixel : picture) {
    const float most = kBrightest;
    pixel = lesser(scale * pixel, Float4{most, most, most, most});
  }
  if (!fast_) {
    bloom(picture);
    displace_red(picture);
    gather_glare(picture);
  }

  const auto gain = static_cast<float>(gain_), noisiness = static_cast<float>(noise_scale_);
  const float shot = noisiness * noisiness * gain / kFullWell;
  const float read = noisiness * kReadNoise * gain / kFullWell, read2 = read * read;
  uyvy.resize(picture.size() * 2);
  double sum = 0.0;
  chroma_.resize(picture.size() / 2);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                         static_cast<std::size_t>(x);
      Float4 signal = picture[pixel];
      if (!fast_) signal += glare(x, y);
      signal *= vignette_[pixel];
      const Float4 variance = shot * greater(signal, Float4{}) + read2;
      signal += root(variance) * noise(frame, static_cast<std::uint32_t>(pixel));
      const Float4 rgb = developed(signal);
      const float level = luma(rgb), r = rgb[0], b = rgb[2];
      uyvy[2 * pixel + 1] = byte(level);
      const Float4 chroma{0.564334f * (b - level), 0.713267f * (r - level), 0.0f, 0.0f};
      chroma_[pixel / 2] = (pixel & 1) != 0 ? 0.5f * (chroma_[pixel / 2] + chroma) : chroma;
      sum += static_cast<double>(std::min(level, kMeterCap));
    }
  }
  for (int pass = 0; pass < chroma_smoothing_; ++pass) smooth_chroma();
  for (std::size_t i = 0; i < chroma_.size(); ++i) {
    uyvy[4 * i] = byte(128.0f + saturation_ * chroma_[i][0]);
    uyvy[4 * i + 2] = byte(128.0f + saturation_ * chroma_[i][1]);
  }
  adapt(t, sum / static_cast<double>(picture.size()));
}

}  // namespace gatefly::sim
