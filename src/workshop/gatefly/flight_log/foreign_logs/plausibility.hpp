// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/flight_log/foreign_logs/foreign_flight.hpp"

namespace gatefly::foreign_logs {

/// Findings on the units, axes and signs of a flight's numbers.
struct Plausibility {
  std::vector<std::string> wrong;    ///< Numbers that no flight can have, one line each.
  std::vector<std::string> checked;  ///< Checked and found well.
  std::vector<std::string> unknown;  ///< Not shown by this log.
};

/// Looks at an IMU by what it must read: gravity at rest, upwards; a gyro that rests with it, and never turns faster than gyros can;
/// and, where the log has an attitude, rates that turn it.
[[nodiscard]] Plausibility plausibility_of(const ForeignFlight& flight);

}  // namespace gatefly::foreign_logs
