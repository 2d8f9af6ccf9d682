// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gatefly::config {

/// Refuses what load_config() refuses of a file with this content, which need not be there yet.
/// @param name  the file's, in messages. @throws std::runtime_error one line.
void check_config(const std::string& content, const std::string& name);

}  // namespace gatefly::config
