// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/race/pilot_config.hpp"

namespace gatefly::config {

/// A pilot's configuration from the files that the program reads: it flies as you fly.
///
/// @param track     a track file, or a name of those that gatefly comes with.
/// @param configs   camera, vehicle and what else is set: files or names, the later wins.
/// @param settings  "section.key=value", after all files.
/// @throws std::runtime_error one line: file, line, key, value, what is allowed.
[[nodiscard]] PilotConfig read_pilot_config(const std::string& track,
                                            const std::vector<std::string>& configs = {},
                                            const std::vector<std::string>& settings = {});

/// The same, where files or texts of files may be given.
struct PilotSources {
  std::string track;                  ///< File or name; "": the text counts.
  std::string track_text;             ///< Content of a track file.
  std::vector<std::string> configs;   ///< Files or names.
  std::string config_text;            ///< Content of one more file, after these.
  std::vector<std::string> settings;  ///< "section.key=value", after all of it.
};

/// A pilot's configuration, and how its camera stores pictures.
struct PilotFiles {
  PilotConfig pilot;
  int stored_width = 0, stored_height = 0;  ///< [px]
  int stored_rotation_deg = 0;              ///< Counter-clockwise, until it is upright.
};

/// @throws std::runtime_error one line; a text is called "track text", "config text".
[[nodiscard]] PilotFiles read_pilot_files(const PilotSources& sources);

}  // namespace gatefly::config

/// The names until 0.3; they go with 0.4.
namespace gatefly::io {
using config::PilotFiles;
using config::PilotSources;
using config::read_pilot_config;
using config::read_pilot_files;
}  // namespace gatefly::io
