// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/experiments/labelled_set.hpp"

namespace gatefly::experiments {

/// A picture that shows what the paper's detector gets right or wrong.
struct DetectionExample {
  std::string kind, rule;  ///< How it was chosen.
  std::optional<std::size_t> picture = {};
  std::optional<GateDetection> found = {};  ///< The detection shown; nothing if missed.
};

/// The examples of Li18's figure "ROC examples", by rule: the hit of median colour fitness, the
/// false positive of the highest that touches no gate, the largest gate that no run finds.
/// @param runs  of one detector over the set; the first one's detections are shown.
/// @param unlabelled  gates without a label, by picture.
[[nodiscard]] std::array<DetectionExample, 3> detection_examples(
    const LabelledSet& set, const std::vector<Found>& runs,
    const std::vector<std::vector<Quad>>& unlabelled);

/// The pictures with labels and detections, and below each its colour mask.
[[nodiscard]] drawing::Canvas drawn_examples(const LabelledSet& set, const Found& found,
                                             const std::array<DetectionExample, 3>& examples,
                                             const ColorRange& color);

}  // namespace gatefly::experiments
