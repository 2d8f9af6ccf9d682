// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/twin_pictures.hpp"

namespace gatefly::experiments {

/// The three detectors that are compared.
enum class TwinMode { kPaper, kFlown, kOurs };
inline constexpr std::array kTwinModes{TwinMode::kPaper, TwinMode::kFlown, TwinMode::kOurs};
[[nodiscard]] const char* name_of(TwinMode mode);

/// Bins of apparent size: where the labelled area puts a gate of 1 m.
inline constexpr std::array<double, 6> kTwinBins{0, 2, 3, 4, 5, 6};  // [m]
inline constexpr std::size_t kTwinBinCount = kTwinBins.size() - 1;
/// -1: farther.
[[nodiscard]] int bin_of(const Quad& gate);

/// A detector's outcome on one picture.
struct TwinOutcome {
  double hit = 0.0;                     ///< Part of the repeats in which the gate was found.
  double false_positives = 0.0;         ///< Mean of the repeats.
  std::vector<double> corner_errors{};  ///< In the first repeat's hits, best order [px].
};

/// On all cores. Rule overlap70; the paper's offline detector is counted as its authors did.
[[nodiscard]] std::vector<TwinOutcome> outcomes(std::span<const TwinPicture> pictures,
                                                TwinMode mode, const std::string& config,
                                                int repeats);

/// Mean of so many with its 95 % interval; a rate's is Wilson's.
struct TwinRate {
  int count = 0;
  double mean = 0.0, low = 0.0, high = 0.0;
};

/// Rates of gates by bin, and false positives a picture.
struct TwinRates {
  std::array<TwinRate, kTwinBinCount> bins{};
  TwinRate false_positives_with_gate, false_positives_without;
};
[[nodiscard]] TwinRates rates(std::span<const TwinPicture> pictures,
                              std::span<const TwinOutcome> outcomes);

/// Several sets as one.
[[nodiscard]] TwinRates pooled(std::span<const TwinRates> sets);

/// Means of rendered sets as if each had as many gates and pictures of a kind as its real one.
[[nodiscard]] TwinRates weighted(std::span<const TwinRates> rendered,
                                 std::span<const TwinRates> real);

}  // namespace gatefly::experiments
