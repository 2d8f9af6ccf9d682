// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gatefly/config/schema.hpp"
#include "gatefly/world/faults.hpp"

namespace gatefly::config {

/// The keys of [faults], in track files, configurations and --set alike.
[[nodiscard]] const std::vector<Key<world::Faults>>& fault_keys();

/// Whether `value` may stand at `key` of [faults].
/// @throws std::runtime_error "where: faults.key ..." when not, or when there is no such key.
void check_fault(const std::string& key, const nlohmann::json& value, const std::string& where);

/// `base` with a [faults] table put over it. @throws std::runtime_error as check_fault.
[[nodiscard]] world::Faults with_faults(const world::Faults& base, const nlohmann::json& table,
                                        const std::string& where);

/// @throws std::runtime_error when a fault is of a gate that a course of so many does not have.
void expect_gates_of(const world::Faults& faults, std::size_t gates, const std::string& track);

}  // namespace gatefly::config
