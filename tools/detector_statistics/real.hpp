// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "looks.hpp"

namespace gatefly::measuring {

/// Real pictures with labels, seen as the pilot would.
struct RealLooks {
  LooksOfBoth clear;  ///< basement32_hq, cyberzoo, distance51, flight_11: careful JPEGs.
  LooksOfBoth video;  ///< basement580: its video was recoded at a low quality.
};

/// @param data  folder of real data; "": where `gatefly reproduce` looks.
/// @throws std::runtime_error one line: data that is missing or wrong.
[[nodiscard]] RealLooks look_at_real(const std::string& data);

}  // namespace gatefly::measuring
