// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gatefly/sim/detector_statistics.hpp"

#include "looks.hpp"

namespace gatefly::measuring {

/// A detector's numbers: from real pictures where there are enough, else from rendered ones.
/// @param real  careful pictures; may be empty.
[[nodiscard]] sim::DetectorStatistics fitted(const Looks& rendered, const Looks& real);

/// What was counted, for a reader.
void print(const std::string& title, const Looks& looks);
void print(const std::string& title, const sim::DetectorStatistics& statistics);

/// The header that the simulator reads.
[[nodiscard]] std::string header_of(const sim::DetectorStatistics& ours,
                                    const sim::DetectorStatistics& paper,
                                    const std::string& measured_on);

}  // namespace gatefly::measuring
