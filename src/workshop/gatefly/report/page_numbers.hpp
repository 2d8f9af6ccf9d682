// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "gatefly/files/json.hpp"

namespace gatefly::report {

// Steps of a page's numbers, of whatever unit: thousandths, tenths and hundredths of those.
inline constexpr double kMilli = 1e-3, kTenth = 1e-4, kHundredth = 1e-5;

/// Rounded for a page: to millimetres, milliradians, or to multiples of `unit`.
[[nodiscard]] inline nlohmann::ordered_json rounded(double value, double unit = kMilli) {
  return files::number(std::round(value / unit) / std::round(1.0 / unit));
}

/// [x, y, z] in millimetres.
[[nodiscard]] inline nlohmann::ordered_json place(const Eigen::Vector3d& p) {
  return nlohmann::ordered_json::array({rounded(p.x()), rounded(p.y()), rounded(p.z())});
}

}  // namespace gatefly::report
