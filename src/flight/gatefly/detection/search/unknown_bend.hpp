// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/refined_side.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::refinement {

/// Radial distortion estimated from one frame when the lens is unknown: r (1 - k r²) about the
/// picture's middle, with the k that fits the crossings of all four sides best.
class UnknownBend {
 public:
  /// @param guess  what it is thought to be, to begin with.
  UnknownBend(const Image& image, const Quad& frame, const SideCurves& guess = {})
      : middle_px_{0.5 * (image.width() - 1), 0.5 * (image.height() - 1)},
        strong_{kStrong / (static_cast<double>(image.width()) * image.width())} {
    for (std::size_t i = 0; i < 4; ++i)
      shows_ = shows_ || strong_ * bulge(frame[i], frame[(i + 1) % 4]).norm() > kShown;
    if (!guess.bent()) return;
    double moment = 0.0, weight = 1e-9;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d &a = frame[i], &b = frame[(i + 1) % 4], of_one = bulge(a, b);
      moment += of_one.dot(guess.sag(a, b)), weight += of_one.squaredNorm();
    }
    k_ = std::clamp(moment / weight, 0.0, 1.5 * strong_);
  }

  /// Whether a strong one would show on this frame.
  [[nodiscard]] bool shows() const { return shows_; }
  [[nodiscard]] Eigen::Vector2d sag(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    return k_ * bulge(a, b);
  }
  /// Bends the lines more or less, as their crossings say.
  void adapt(const Quad& corners, const std::array<Curvature, 4>& curvatures, double eager,
             std::array<Side, 4>& sides) {
    std::array<double, 4> curve{};  // of the sides, with k = 1
    double moment = 0.0, weight = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % 4];
      Side side{a, b};
      side.bend(a, b, bulge(a, b));
      curve[i] = side.curve;
      moment += curve[i] * curvatures[i].moment;
      weight += curve[i] * curve[i] * curvatures[i].weight;
    }
    // A bend is improbable: so many crossings say that there is none.
    const double doubt = kDoubt / (strong_ * strong_), before = k_;
    k_ = std::clamp(k_ + eager * (moment - doubt * k_) / (weight + doubt), 0.0, 1.5 * strong_);
    for (std::size_t i = 0; i < 4; ++i) curvatures[i].add_to(sides[i], (k_ - before) * curve[i]);
  }

 private:
  // 1 / (3 f²) of an equidistant lens of 150 degrees, f in widths
  static constexpr double kStrong = 2.3;
  static constexpr double kShown = 1.0;  // px
  static constexpr double kDoubt = 4.0;  // px²

  // The sag with k = 1: half a chord, squared, times how far its middle is from the picture's,
  // across it.
  [[nodiscard]] Eigen::Vector2d bulge(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    const Eigen::Vector2d half = 0.5 * (b - a), off = 0.5 * (a + b) - middle_px_;
    return half.squaredNorm() * off - off.dot(half) * half;
  }

  Eigen::Vector2d middle_px_;
  double strong_, k_ = 0.0;  // 1/px²
  bool shows_ = false;
};

}  // namespace gatefly::refinement
