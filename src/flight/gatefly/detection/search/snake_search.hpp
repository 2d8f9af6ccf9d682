// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/picture_color.hpp"
#include "gatefly/detection/search/bar_finder.hpp"
#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Finds gates that stand out, in microseconds: Li18's snakes (Algorithm 1), in strides.
///
/// Two bars of like slope and height are the sides of a frame; its level bars are looked for
/// between them, then all four sides are fitted. What differs from the paper: no random samples,
/// evidence in place of a colour box, upright bars first at any roll up to 60 deg (one pair of a
/// frame's sides is always within 45 deg of upright), sides as the lens bends them.
class SnakeSearch {
 public:
  explicit SnakeSearch(const GateDetectorParams& params = {});

  /// Distinct gates, best first. Allocates nothing; the cost hardly depends on the picture's size.
  [[nodiscard]] GateDetections detect(const Image& image, const PictureColor& color);

  /// The gate whose bars' middle lines are expected near these, in the picture that was searched
  /// last; nullopt where there is none. Less will do than for a gate that nobody expects.
  [[nodiscard]] std::optional<GateDetection> detect_near(const Quad& bars_px, const Image& image,
                                                         const PictureColor& color) const;

  /// Whether the picture that was searched last shows a bar left or right of all these gates: there
  /// may be another one.
  [[nodiscard]] bool shows_bars_beside(const GateDetections& gates) const;

  /// Bars of the picture that was searched last.
  [[nodiscard]] const BarFinder::Bars& bars() const { return finder_.bars(); }

 private:
  struct Pair;
  using Pairs = FixedList<Pair, 4>;

  [[nodiscard]] Pairs pairs_of(const BarFinder::Bars& bars) const;

  GateDetectorParams params_;
  BarFinder finder_;
  LensBend bend_;
};

}  // namespace gatefly
