// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/guard/ardu_interview.hpp"
#include "gatefly/guard/interview.hpp"
#include "gatefly/guard/px4_interview.hpp"
#include "gatefly/live/drone_file.hpp"

// A controller's answers beside the constants of drone.toml.

namespace gatefly::live {

/// The differences between a controller and the file, a line each; empty: it is the drone.
[[nodiscard]] std::vector<std::string> differences(const DroneFile& drone,
                                                   const guard::DroneFacts& facts,
                                                   const std::string& board);
[[nodiscard]] std::vector<std::string> differences(const DroneFile& drone,
                                                   const guard::ArduFacts& facts);
[[nodiscard]] std::vector<std::string> differences(const DroneFile& drone,
                                                   const guard::Px4Facts& facts);

/// An ArduCopter's or a PX4's own parameters, as the file stores them. Only where guard::complaints_about() has none.
[[nodiscard]] ArduDrone ardu_drone_of(const guard::ArduFacts& facts);
[[nodiscard]] Px4Drone px4_drone_of(const guard::Px4Facts& facts);

}  // namespace gatefly::live
