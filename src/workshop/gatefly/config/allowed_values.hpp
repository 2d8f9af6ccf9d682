// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gatefly/config/schema.hpp"

namespace gatefly::config {

/// Allowed values in words: "a whole number in 1..100", "one of "full", "fast"".
[[nodiscard]] std::string allowed_values(const KeyRule& rule);

}  // namespace gatefly::config
