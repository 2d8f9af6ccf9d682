// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gatefly/config/config.hpp"

namespace gatefly::config {

/// The keys of [sim], part of config_keys().
[[nodiscard]] std::vector<Key<Config>> sim_keys();

}  // namespace gatefly::config
