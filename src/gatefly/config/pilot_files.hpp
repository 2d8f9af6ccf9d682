// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/race/pilot_config.hpp"

namespace gatefly::io {

/// What a pilot is told, from the files that the program reads: what it flies is what you fly.
///
/// @param track     a track file, or a name of those that gatefly comes with.
/// @param configs   camera, vehicle and what else is set: files or names, the later wins.
/// @param settings  "section.key=value", after all files.
/// @throws std::runtime_error one line: file, line, key, value, what is allowed.
[[nodiscard]] PilotConfig read_pilot_config(const std::string& track,
                                            const std::vector<std::string>& configs = {},
                                            const std::vector<std::string>& settings = {});

}  // namespace gatefly::io
