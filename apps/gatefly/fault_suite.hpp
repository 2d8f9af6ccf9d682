// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "race_options.hpp"

namespace gatefly::cli {

struct FaultSuiteOptions {
  RaceOptions race;  ///< Its vision is each row's own.
  int runs = 20, jobs = 0;
  std::uint64_t first_seed = 6001;
  std::string out;
  std::vector<std::string> only;  ///< "F1", ...; none: all.
};

/// `campaign --faults`: a campaign for every row of the fault table, each in a folder of its own below
/// `out`, and faults.csv and faults.md of them all.
/// @returns kDone when all were flown, whatever their rules say, or kInterrupted.
/// @throws std::runtime_error one line.
[[nodiscard]] int fault_suite(const FaultSuiteOptions& options);

}  // namespace gatefly::cli
