// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "gatefly/estimation/eskf/findings.hpp"

namespace gatefly::flight_log {

/// Findings of a filter on camera, air and map, each with its sigma; null when it looks for none
/// of it.
[[nodiscard]] nlohmann::ordered_json as_json(const std::optional<eskf::Findings>& findings);

/// The same in a line; "" when it looks for none of it.
[[nodiscard]] std::string text_of(const std::optional<eskf::Findings>& findings);

}  // namespace gatefly::flight_log
