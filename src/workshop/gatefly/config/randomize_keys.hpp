// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/config/schema.hpp"
#include "gatefly/world/randomize.hpp"

namespace gatefly::config {

/// The keys of [randomize] but `level`: one standard deviation each. simulation.md has the levels.
[[nodiscard]] const std::vector<Key<world::Randomize>>& randomize_keys();

/// The key `level` itself.
[[nodiscard]] const KeyRule& randomize_level_rule();

/// Whether `value` may stand at `key` ("level" or one of the above) of [randomize].
/// @throws std::runtime_error "where: randomize.key ..." when not, or when there is no such key.
void check_randomize(const std::string& key, const nlohmann::json& value, const std::string& where);

/// `base` with a [randomize] table put over it: first its level, if it has one, then its other
/// keys.
/// @throws std::runtime_error as check_randomize.
[[nodiscard]] world::Randomize randomized(const world::Randomize& base, const nlohmann::json& table,
                                          const std::string& where);

}  // namespace gatefly::config
