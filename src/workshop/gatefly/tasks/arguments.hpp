// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/config/config.hpp"

namespace gatefly::tasks {

/// Configuration arguments of every task.
struct ConfigArguments {
  std::vector<std::string> configs;   ///< Files or names in configs/, the later wins.
  std::vector<std::string> settings;  ///< "section.key=value", after all files.
};

/// configs/default.toml, then the configurations, then the settings.
/// @throws std::runtime_error one line.
[[nodiscard]] inline config::Config load(const ConfigArguments& arguments) {
  return config::load_config(config::config_files(arguments.configs), arguments.settings);
}

}  // namespace gatefly::tasks
