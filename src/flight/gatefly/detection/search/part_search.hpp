// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/picture_color.hpp"
#include "gatefly/detection/search/bar_finder.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Finds a gate that the border cuts: Li18 §3.1, last paragraph, and its lower or upper corners
/// where they are in view.
///
/// The same bars as for whole gates. Two that could be the sides of one gate: where both leave the
/// picture, nothing more is asked; else a level bar must join them, as far as it is in the picture.
/// In place of the paper's column histogram. [ours, docs/paper/deviations.md#bars]
class PartSearch {
 public:
  explicit PartSearch(const GateDetectorParams& params = {});

  /// The largest such gate; nullopt when there is none, or when it is whole. One of boards also when
  /// it is whole, but only when two of its corners are seen. Allocates nothing.
  [[nodiscard]] std::optional<GatePart> detect(const Image& image, const PictureColor& color);

 private:
  GateDetectorParams params_;
  LensBend bend_;
  BarFinder bars_;
};

}  // namespace gatefly
