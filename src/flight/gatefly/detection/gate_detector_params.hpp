// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/sensing/camera.hpp"

namespace gatefly {

/// Weights and limits by which a frame is taken for a gate. [chosen on the labelled sets, whole and spoilt in 24 ways,
/// docs/paper/results.md#other-pictures]
struct FrameWeights {
  double weakest = 0.6, inside = 0.5, outside = 0.5, beyond = 1.2;
  /// With every doubling of the side, 0 at 50 px.
  double size = 0.0;
  double added = 0.0;  ///< For the picture at hand, see PictureColor::faintness().
};

/// The lens that pictures were taken with: bars are looked for along its bend.
struct PictureLens {
  std::optional<AnyCamera> model;  ///< None: bars are straight.
  /// Size of the upright pictures that it belongs to [px]: others of the same shape are taken for
  /// scaled ones, in those of another shape bars are straight. 0: pictures of any size are its own.
  int width = 0, height = 0;
  /// Pictures of any shape are its own: scaled by the width, its centre as far from the picture's
  /// middle.
  bool any_shape = false;
};

/// Thresholds of the fast and of the careful search.
struct GateDetectorParams {
  /// Least FrameScore::total; at it, one in two frames is a gate. [docs/paper/results.md]
  double min_score = 2.5;
  /// Score of the fast search from which no careful one follows. [of 2.5, 3, 3.5, 4.5: a gate in
  /// 150 less than with 3.5, and seldom a second look]
  double sure_score = 3.0;
  /// Whether evidence is what stands out in this very picture, see tone_of(); else the colours as
  /// they are.
  bool adapts = true;
  double max_inside = 0.5;     ///< Evidence in the opening [nats]: a filled square is no gate.
  double max_roll_deg = 60.0;  ///< Limit of the careful search.
  double min_side_px = 10.0;   ///< Least length of the bars' centre lines.
  double max_aspect = 3.2;
  /// From the bars' middle lines to the corners that are meant: outer ones.
  double corner_scale = 1.0 / 0.95;
  double bar_ratio = 0.05;  ///< Bar width / outer side of the gate.
  FrameWeights weights = {};
  PictureLens lens = {};

  /// Weights for a picture whose frames lack so much.
  [[nodiscard]] FrameWeights weights_with(double added) const {
    FrameWeights with = weights;
    with.added = added;
    return with;
  }
  /// Whether bars are boards.
  [[nodiscard]] bool has_boards() const { return bar_ratio >= kLeastBoard; }
  /// Bar width / side of the bars' middle lines.
  [[nodiscard]] double bar() const { return bar_ratio / (1.0 - bar_ratio); }
};

}  // namespace gatefly
