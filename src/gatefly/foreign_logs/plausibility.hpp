// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/foreign_logs/foreign_flight.hpp"

namespace gatefly::foreign_logs {

/// What the numbers of a flight say about their units, axes and signs.
struct Plausibility {
  std::vector<std::string> wrong;    ///< What no flight's numbers can be, one line each.
  std::vector<std::string> checked;  ///< What was looked at and is well.
  std::vector<std::string> unknown;  ///< What this log cannot show.
};

/// Looks at an IMU by what it must read: gravity at rest, upwards; a gyro that rests with it, and never turns faster than gyros can;
/// and, where the log has an attitude, rates that turn it.
[[nodiscard]] Plausibility plausibility_of(const ForeignFlight& flight);

}  // namespace gatefly::foreign_logs
