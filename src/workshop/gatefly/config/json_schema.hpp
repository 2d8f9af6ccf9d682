// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

// JSON Schemas, draft 7, with which editors complete and check a file while it is written. Made of
// the tables that the readers use, so that the two cannot differ.
namespace gatefly::config {

/// Schema of a track file: track_keys(), randomize_keys() and fault_keys().
[[nodiscard]] nlohmann::ordered_json track_schema();

/// Schema of a configuration, camera or vehicle file: config_keys(), randomize_keys() and
/// fault_keys().
[[nodiscard]] nlohmann::ordered_json config_schema();

}  // namespace gatefly::config
