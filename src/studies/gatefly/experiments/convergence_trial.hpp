// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/filter_race.hpp"

namespace gatefly::experiments {

// How the errors of the drag filter and of the classic filter fall after the first fix of a flight:
// curves of kPoints points, from one second before it to twenty after.

inline constexpr double kPerSecond = 10.0;                   ///< Points of the curves.
inline constexpr std::size_t kFirstFix = 10, kPoints = 211;  ///< From -1 s to 20 s.

/// Seconds since the first fix.
[[nodiscard]] constexpr double time_of(std::size_t point) {
  return (static_cast<double>(point) - kFirstFix) / kPerSecond;
}
[[nodiscard]] constexpr std::size_t point_at(double t) {
  return static_cast<std::size_t>(t * kPerSecond + kFirstFix + 0.5);
}
inline constexpr double kTo = time_of(kPoints - 1);

enum ErrorOf : std::size_t { kBias, kPosition, kVelocity, kTilt, kWhats };

/// Errors of one filter over one flight; empty curves when it was over before kTo.
using ErrorCurves = std::array<std::vector<double>, kWhats>;

struct Condition {
  std::string key, name;
  FilterConditions given = {};

  /// The classic filter is told no drag.
  [[nodiscard]] bool changes_imu15() const { return given.told_drag == 1.0; }
};

/// As flown, and one thing after another otherwise.
[[nodiscard]] std::vector<Condition> conditions(bool quick);

/// Those noises of the classic filter that find the bias soonest, on flights that are not shown.
[[nodiscard]] baseline::Imu15Params tuned_for_bias(const Options& options);

/// Both filters' traces over one flight, by condition: drag filter, classic filter.
using FlightCurves = std::vector<std::pair<ErrorCurves, ErrorCurves>>;
[[nodiscard]] FlightCurves curves_of(std::uint64_t seed, const std::vector<Condition>& list,
                                     const baseline::Imu15Params& classic);
/// All its curves reach kTo.
[[nodiscard]] bool is_whole(const FlightCurves& flight);

/// Both filters' errors under one condition; run i is the same flight in both.
struct BothFilters {
  std::array<Samples, kWhats> drag, imu15;
};
[[nodiscard]] BothFilters gathered(const std::vector<FlightCurves>& flights, std::size_t condition);

/// Classic filter's median error over the drag filter's.
[[nodiscard]] double median_ratio(const BothFilters& pair, ErrorOf what, double t);

/// When that part of the flights is below a threshold for the first time [s]; NaN: not by kTo.
[[nodiscard]] double time_below(const Samples& samples, double part, double threshold);

/// From when on the classic filter's median error of the bias is the smaller one, for two seconds
/// at least; infinite: not by kTo.
struct Crossover {
  double t = 0.0, low = 0.0, high = 0.0;  ///< With the 90 % band of flights drawn anew [s].
};
[[nodiscard]] Crossover crossover(const BothFilters& pair);

}  // namespace gatefly::experiments
