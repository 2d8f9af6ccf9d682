// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "gatefly/experiments/own_sets.hpp"
#include "gatefly/experiments/picture_changes.hpp"

namespace gatefly::experiments {

/// The pictures of one half of a set under one change.
struct ChangedHalf {
  std::vector<UprightPicture> pictures;  ///< Behind the labelled ones.
  std::vector<tuning::LabelledImage> labelled;
};
using ChangedSet = std::array<ChangedHalf, 2>;

/// A set as 8-bit RGB.
using UprightHalves = std::array<std::vector<UprightPicture>, 2>;
[[nodiscard]] UprightHalves upright_halves(const OwnSet& set);
/// Without the pictures that leave no room for the change. On all cores.
[[nodiscard]] ChangedSet changed_set(const UprightHalves& halves, const PictureChange& change);

/// Hits of gates, and false positives a picture.
struct ChangedRate {
  double true_positive_rate = 0.0, false_per_image = 0.0;
  /// Thresholds of the first and the second half.
  std::array<double, 2> min_scores{};
};

/// The detector's rates on a changed set; where something is chosen, it is chosen on one half
/// and counted on the other.
struct ChangedRates {
  std::size_t pictures = 0;
  int gates = 0;
  ChangedRate shipped;     ///< Described colours, the configuration's threshold.
  ChangedRate other_half;  ///< Described colours; the threshold holds `allowed` on the other half.
  /// Colours that the detector taught itself on the other half, which chose the threshold, too.
  ChangedRate self_tuned;
  ChangedRate best;  ///< Described colours, the best threshold of all for these very pictures.
};

/// @param allowed  false positives a picture.
/// @param tune     whether to tune, which takes the longest; else `self_tuned` stays 0.
[[nodiscard]] ChangedRates rates_of(const ChangedSet& changed, const OwnSet& set, bool every_gate,
                                    double allowed, bool tune);

}  // namespace gatefly::experiments
