// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "gatefly/sim/detector_statistics.hpp"

#include "looks.hpp"

namespace gatefly::measuring {

/// Upper ends of the bins of apparent size; the last one holds for what is larger, too [px].
inline constexpr std::array<double, 5> kSizes{25.0, 35.0, 50.0, 80.0, 1e9};
[[nodiscard]] std::size_t bin_of(double side_px);

/// Part of the looks that are hits; 0 without looks.
[[nodiscard]] double rate_of(const std::vector<Look>& looks);
/// The same, bin by bin of apparent size.
[[nodiscard]] std::vector<Look> in_bin(const std::vector<Look>& looks, std::size_t bin);

/// Which things share a seed's draw.
enum class Share { kAll, kEachItsOwn };

/// Tetrachoric correlation of looks at the same thing, `lag` pictures apart; nullopt where hits or
/// misses are too few.
[[nodiscard]] std::optional<double> correlation(const std::vector<Look>& looks, int lag);
/// The same of looks of one seed in different windows.
[[nodiscard]] std::optional<double> correlation_of_seeds(const std::vector<Look>& looks,
                                                         Share share);
/// Seed + row exp(-lag / time), nearest to the correlations.
[[nodiscard]] sim::Staying staying_of(const std::vector<Look>& looks, Share share);
/// Of places that nobody knows but by their alarms. @param rate  alarms / places in view.
[[nodiscard]] sim::Staying staying_of(const std::vector<Alarm>& alarms, double rate);

[[nodiscard]] sim::Quantiles quantiles_of(std::vector<double> values);
[[nodiscard]] std::vector<double> fitness_of(const std::vector<Look>& looks);

[[nodiscard]] sim::CornerErrors corner_errors_of(const std::vector<Look>& looks);

}  // namespace gatefly::measuring
