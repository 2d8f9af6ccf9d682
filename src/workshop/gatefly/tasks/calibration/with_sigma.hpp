// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "gatefly/files/text.hpp"

namespace gatefly::calibration {

/// "169.23 ± 0.02": as many digits as the sigma deserves.
[[nodiscard]] inline std::string with_sigma(double value, double sigma) {
  const int digits =
      sigma > 0.0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(sigma))) + 1, 0, 6) : 4;
  return files::fixed(value, digits) + (sigma > 0.0 ? " ± " + files::fixed(sigma, digits) : "");
}

}  // namespace gatefly::calibration
