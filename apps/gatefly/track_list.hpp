// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands.hpp"

namespace gatefly::cli {

/// gatefly fly --list: the tracks in tracks/, a line or a JSON object each.
int list_tracks(const CommonOptions& options, bool json);

}  // namespace gatefly::cli
