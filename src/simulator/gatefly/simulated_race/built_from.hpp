// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gatefly::simulated_race {

/// The commit this program was built from: twelve digits, then "+" and a fingerprint where the code
/// differed from it; "unknown" outside of a clone.
[[nodiscard]] std::string built_from();

}  // namespace gatefly::simulated_race
