// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/sim/detector_statistics.hpp"

#include "looks.hpp"

namespace gatefly::measuring {

/// A detector's numbers: from real pictures where there are enough, else from rendered ones.
/// @param real  careful pictures; may be empty.
[[nodiscard]] sim::DetectorStatistics fitted(const Looks& rendered, const Looks& real);

/// What was counted, for a reader.
void print(const std::string& title, const Looks& looks);
void print(const std::string& title, const sim::DetectorStatistics& statistics);

/// A table of the header that the simulator reads.
struct NamedTable {
  std::string name;
  sim::DetectorStatistics statistics;
};
[[nodiscard]] std::string header_of(const std::vector<NamedTable>& tables,
                                    const std::string& measured_on);

}  // namespace gatefly::measuring
