// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/flight_log/replay.hpp"
#include "gatefly/tasks/recorded_flight.hpp"

namespace gatefly::cli {

/// A flight as a smoother has it, for `replay --smooth`.
struct SmoothedFlight {
  std::vector<flight_log::EstimateRow> estimates;  ///< In place of the filter's, row by row.
  std::vector<std::string> lines;                  ///< Lines to print ...
  nlohmann::json json;                             ///< ... and what `--json` says as "smoothed".
};

/// Follows a replay, and smooths it when it is over.
class FlightSmoother {
 public:
  virtual ~FlightSmoother() = default;
  virtual void follow(const flight_log::ReplayedTick& tick) = 0;
  /// @param now_and_then  called often; may throw to stop.
  /// @throws std::runtime_error one line: there is nothing to smooth.
  [[nodiscard]] virtual SmoothedFlight smoothed(const tasks::RecordedFlight& flight,
                                                const flight_log::ReplayResult& result,
                                                const std::function<void()>& now_and_then) = 0;
};

/// nullptr: this program has none; `gatefly` hands over to `gatefly-lab`.
[[nodiscard]] std::unique_ptr<FlightSmoother> flight_smoother();

}  // namespace gatefly::cli
