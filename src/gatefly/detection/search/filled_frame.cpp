// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/filled_frame.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

namespace gatefly {
namespace {

constexpr int kSamples = 12;                   // of a side
constexpr double kFirst = 0.15, kPart = 0.70;  // of a side, without its corners
constexpr double kBeside = 0.0637;             // as FrameFit looks beside a bar, of the side
constexpr double kLeastOffset = 3.0;           // [px]

// Of the bars' contrast; half of the openings have less than .15, one in twenty more than .6. [of
// .15 - .7, and 0.7 - 2.5 nats: labelled sets lose nothing, screens in a rendered hall most]
constexpr double kAllowed = 0.6, kNats = 1.5, kMost = 1.5;
constexpr double kNoise = 3.0;  // [levels]

/// Sums of chroma at pixels that are all in the picture, or none is counted.
struct Chromas {
  Eigen::Vector2d inside{0, 0}, outside{0, 0}, bar{0, 0};
  int count = 0;
};

Chromas along_side(const Image& image, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                   double off, const SideCurves& curves) {
  Chromas sum;
  const Eigen::Vector2d d = b - a, sag = curves.sag(a, b);
  const Eigen::Vector2d in = off * Eigen::Vector2d{-d.y(), d.x()} / std::max(1e-9, d.norm());
  const auto pixel = [](const Eigen::Vector2d& p) -> Eigen::Vector2i {
    return (p.array() + 0.5).floor().cast<int>();
  };
  const auto chroma = [&](const Eigen::Vector2i& p) {
    const Yuv c = image.at(p.x(), p.y());
    return Eigen::Vector2d{c.u, c.v};
  };
  const auto shows = [&](const Eigen::Vector2i& p) { return image.contains(p.x(), p.y()); };
  for (int k = 0; k < kSamples; ++k) {
    const double t = kFirst + kPart * (k + 0.5) / kSamples;
    const Eigen::Vector2d on = a + t * d + 4.0 * t * (1.0 - t) * sag;
    const Eigen::Vector2i bar = pixel(on), inside = pixel(on + in), outside = pixel(on - in);
    if (!shows(bar) || !shows(inside) || !shows(outside)) continue;
    sum.bar += chroma(bar), sum.inside += chroma(inside), sum.outside += chroma(outside);
    ++sum.count;
  }
  return sum;
}

}  // namespace

double lost_as_filled(const Image& image, const Quad& bars_px, double bar,
                      const SideCurves& curves) {
  const double side = std::sqrt(std::abs(area(bars_px)));
  const double off = std::max(kLeastOffset, (0.5 * bar + kBeside) * side);
  Eigen::Vector2d filling{0, 0}, contrast{0, 0};
  int sides = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Chromas sum = along_side(image, bars_px[i], bars_px[(i + 1) % 4], off, curves);
    if (sum.count < kSamples / 3) continue;
    filling += (sum.inside - sum.outside) / sum.count;
    contrast += (sum.bar - 0.5 * (sum.inside + sum.outside)) / sum.count;
    ++sides;
  }
  if (sides == 0) return 0.0;
  const double part = filling.norm() / (contrast.norm() + kNoise * sides);
  return kNats * std::clamp(part - kAllowed, 0.0, kMost);
}

}  // namespace gatefly
