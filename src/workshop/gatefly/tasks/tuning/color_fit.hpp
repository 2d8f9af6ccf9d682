// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "gatefly/detection/color_model.hpp"
#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::tuning {

/// A gate that colours are learnt from.
struct Example {
  Quad bars_px{};       ///< Middle lines of its bars, good to a few pixels.
  double weight = 1.0;  ///< How sure it is a gate, 0..1.
};

/// A picture to fit colours to. What lies near no quad is background.
struct ColorPicture {
  Image image;
  std::vector<Example> gates = {};
  /// Middle lines of what is neither surely a gate nor surely none.
  std::vector<Quad> unsure = {};
};

struct ColorFitParams {
  double bar_ratio = 0.05;  ///< Bar width / side of the gate.
  /// The prior counts as much as so many gates. [of 0.5-100: all within .02 of hits]
  double prior_gates = 2.0;
  PictureLens lens = {};  ///< Bars are as it bends them.
  int rounds = 4;         ///< Rounds of fitting the colours and then the gates to them.
};

/// Log-likelihood ratios of bar pixels against background, blended with what is believed before.
/// Ours.
///
/// Quads are only roughly on the bars, so fit and pull take turns: tables from the pixels near the
/// quads, each counted by the chance that it is a bar; the quads' sides moved onto what the tables
/// find. Few gates leave the prior nearly as it is; many replace it.
/// @param prior  e.g. ColorModel::described().
[[nodiscard]] ColorModel fit_colors(std::span<const ColorPicture> pictures, const ColorModel& prior,
                                    const ColorFitParams& params = {});

}  // namespace gatefly::tuning
