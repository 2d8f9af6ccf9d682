// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/filled_frame.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "gatefly/detection/search/frame_fit.hpp"

namespace gatefly {
namespace {

constexpr int kSamples = 12;                   // of a side
constexpr double kFirst = 0.15, kPart = 0.70;  // of a side, without its corners
constexpr double kLeastOffset = 3.0;           // [px]

// Chroma change by the bars' contrast; half of the openings have less than .15, one in twenty more
// than .6. [of .15 - .7, and 0.7 - 2.5 nats: labelled sets lose nothing, screens in a rendered hall
// most]
constexpr double kAllowed = 0.6, kNats = 1.5, kMost = 1.5;
constexpr double kNoise = 3.0;  // [levels]

// The same of luma: how much it changes across a bar, beside how much it varies along the outside.
// One opening in twenty has more than 1.3.
constexpr double kLumaAllowed = 1.4, kLumaMost = 1.0, kLumaNoise = 4.0;

/// Sums over pixels that are all in the picture, or none is counted.
struct Sums {
  Eigen::Vector2d inside{0, 0}, outside{0, 0}, bar{0, 0};  // chroma
  double steps = 0.0;                                      // of luma from outside to inside
  double luma = 0.0, luma_squares = 0.0;                   // outside
  int count = 0;
};

Sums along_side(const Image& image, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double off,
                const SideCurves& curves) {
  Sums sum;
  const Eigen::Vector2d d = b - a, sag = curves.sag(a, b);
  const Eigen::Vector2d in = off * Eigen::Vector2d{-d.y(), d.x()} / std::max(1e-9, d.norm());
  const auto pixel = [](const Eigen::Vector2d& p) -> Eigen::Vector2i {
    return {nearest_cell(p.x()), nearest_cell(p.y())};
  };
  const auto chroma = [](Yuv c) { return Eigen::Vector2d{c.u, c.v}; };
  const auto color = [&](const Eigen::Vector2i& p) { return image.at(p.x(), p.y()); };
  const auto shows = [&](const Eigen::Vector2i& p) { return image.contains(p.x(), p.y()); };
  for (int k = 0; k < kSamples; ++k) {
    const double t = kFirst + kPart * (k + 0.5) / kSamples;
    const Eigen::Vector2d on = a + t * d + 4.0 * t * (1.0 - t) * sag;
    const Eigen::Vector2i bar = pixel(on), inside = pixel(on + in), outside = pixel(on - in);
    if (!shows(bar) || !shows(inside) || !shows(outside)) continue;
    const Yuv in_color = color(inside), out_color = color(outside);
    sum.bar += chroma(color(bar)), sum.inside += chroma(in_color);
    sum.outside += chroma(out_color);
    sum.steps += std::abs(in_color.y - out_color.y);
    sum.luma += out_color.y, sum.luma_squares += out_color.y * out_color.y;
    ++sum.count;
  }
  return sum;
}

}  // namespace

double lost_as_filled(const Image& image, const Quad& bars_px, double bar,
                      const SideCurves& curves) {
  const double side = std::sqrt(std::abs(area(bars_px)));
  const double off = std::max(kLeastOffset, (0.5 * bar + kBesideBar) * side);
  Eigen::Vector2d filling{0, 0}, contrast{0, 0};
  double steps = 0.0, luma = 0.0, luma_squares = 0.0;
  int sides = 0, count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Sums sum = along_side(image, bars_px[i], bars_px[(i + 1) % 4], off, curves);
    if (sum.count < kSamples / 3) continue;
    filling += (sum.inside - sum.outside) / sum.count;
    contrast += (sum.bar - 0.5 * (sum.inside + sum.outside)) / sum.count;
    steps += sum.steps, luma += sum.luma, luma_squares += sum.luma_squares;
    ++sides, count += sum.count;
  }
  if (sides == 0) return 0.0;
  const double part = filling.norm() / (contrast.norm() + kNoise * sides);
  const double mean = luma / count,
               spread = std::sqrt(std::max(0.0, luma_squares / count - mean * mean));
  const double change = steps / count / (spread + kLumaNoise);
  return kNats * (std::clamp(part - kAllowed, 0.0, kMost) +
                  std::clamp(change - kLumaAllowed, 0.0, kLumaMost));
}

}  // namespace gatefly
