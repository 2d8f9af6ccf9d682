// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "gatefly/experiments/attitude_errors.hpp"

namespace gatefly::experiments {

/// Inclination of a hand-held IMU whose true attitude is known (BROAD): ours and Mahony's.
struct HeldErrors {
  AttitudeErrors ours, mahony;
  AttitudeTrace trace;
};

/// @throws std::runtime_error one line, for a file that cannot be used.
[[nodiscard]] HeldErrors held_attitude(const std::filesystem::path& file);

}  // namespace gatefly::experiments
