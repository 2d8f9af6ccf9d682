// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "gatefly/flight_log/replay.hpp"
#include "gatefly/tasks/recorded_flight.hpp"

namespace gatefly::tasks {

/// How many pictures of a set show the gate, and in how many of them it was found.
struct Rate {
  int shown = 0, found = 0;
};

/// The recorded pilot's estimates beside those that came out now.
struct Comparison {
  std::optional<std::size_t> first_other;  ///< Row from which on they are not the same to the bit.
  bool told = false;                       ///< To be another pilot: by --config, --set, --track.
};

/// Report on a flight that was flown again.
struct ReplayReport {
  int fixes = 0;  ///< Pictures that corrected the filter.
  /// Against labels.csv of the folder, in flight only: where the log's truth is off the ground.
  std::optional<Rate> labelled;
  /// Against the geometry: where true position, the log's own attitude and the measured gate say
  /// that the whole gate is in the picture.
  std::optional<Rate> visible;
  /// As `gatefly fly` counts: pictures that show the recorded pilot's next gate whole, and of them
  /// those in which it was found now. Where images.csv says where it is: in our own flights.
  std::optional<Rate> next_gate;
  std::optional<Comparison> comparison;  ///< If the log has the recorded pilot's estimates.
  std::string why_no_fix;                ///< Many gates and no fix: why; "" where all is well.
  /// The filter knows no position, and has not diverged either: why; "" where it does.
  std::string unknown;
  std::string pictures_from;   ///< "files", "film", "rendered", "none".
  std::string other_pictures;  ///< Number of wrong hashes among pictures; "" when none.
};

[[nodiscard]] ReplayReport report_of(const RecordedFlight& flight, const ReplayArguments& arguments,
                                     const flight_log::ReplayResult& result);

/// Output of `gatefly replay --json`.
[[nodiscard]] nlohmann::json as_json(const ReplayReport& report, const ReplayArguments& arguments,
                                     const flight_log::ReplayResult& result);

/// "the same estimates, to the bit", or from where on they are others, and why.
[[nodiscard]] std::string text_of(const Comparison& comparison, const RecordedFlight& flight);

/// Lines of errors in the gate's frame and in earth axes, and of NIS; "" where the log has no truth.
[[nodiscard]] std::string text_of(const flight_log::ReplayScore& score);

/// "predict", "corners", "bars": the column `source` of estimates.csv.
[[nodiscard]] const char* name_of(Sighting::Source source);

[[nodiscard]] std::string estimates_csv(const flight_log::ReplayResult& result);

}  // namespace gatefly::tasks
