// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/simulated_race/closed_loop/consistency.hpp"
#include "gatefly/simulated_race/closed_loop/discoveries.hpp"

namespace gatefly::simulated_race {

/// Fields of one race's summary.json that a campaign keeps.
struct RunRow {
  std::uint64_t seed = 0;
  bool finished = false;
  int gates = 0, gates_total = 0;
  double time = 0.0;  ///< Motors on to the last gate passed [s].
  /// NaN before there is a speed to speak of [m/s].
  double mean_speed = 0.0, max_speed = 0.0;
  /// "finished", "crash: gate 1 left bar", "abort: ...", "timeout".
  std::string cause;
  std::vector<double> rmse;  ///< Estimate's, x y z; NaN without a gate passed [m].
  /// Largest cause of the miss: "estimate", "guidance", "map", "detection", "in the way", ...; ""
  /// when it finished, or an older summary does not say.
  std::string why;
  std::vector<double> shares;  ///< Parts of the miss: those four [cm]; empty when unknown.
  double since_fix = 0.0;      ///< NaN without [s].
  int frames = 0, true_positives = 0, false_positives = 0, searches = 0;
  std::string commit, configuration;  ///< "" when an older summary does not say.
  Consistency consistency;            ///< Nothing in it when an older summary has none.
  /// After the first lap: error and sigma of the camera's tilt [deg], the heading [deg], the thrust
  /// [%], the latency [ms]; empty when nobody says.
  std::vector<FoundError> found;
  /// Through gates that were not the next one; 0 where an older summary does not say.
  int through_false_gates = 0, through_other_gates = 0;
  int map_reports = 0;  ///< Gates of which it said that the map has them elsewhere.
};

/// @param file  whose content it is, in messages.
/// @throws std::runtime_error one line: what is missing or wrong in the summary of a race.
[[nodiscard]] RunRow row_of(const nlohmann::ordered_json& summary,
                            const std::string& file = "summary.json");

struct Interval {
  double low = 0.0, high = 1.0;
};

/// 95 % interval of a probability after `hits` of `trials`. Wilson 1927.
[[nodiscard]] Interval wilson95(int hits, int trials);

/// runs.csv, one row a seed.
[[nodiscard]] std::string runs_csv(const std::vector<RunRow>& rows);

/// Rates, quantiles and causes: what campaign.json says about its runs. The same rows, the same
/// bytes.
[[nodiscard]] nlohmann::ordered_json campaign_result(const std::vector<RunRow>& rows);

}  // namespace gatefly::simulated_race
