// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/pilot_files.hpp"

#include <filesystem>
#include <optional>

#include "gatefly/config/config.hpp"
#include "gatefly/config/derived.hpp"
#include "gatefly/config/texts.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/files/shipped_files.hpp"

namespace gatefly::config {

PilotConfig read_pilot_config(const std::string& track, const std::vector<std::string>& configs,
                              const std::vector<std::string>& settings) {
  return read_pilot_files({track, {}, configs, {}, settings}).pilot;
}

PilotFiles read_pilot_files(const PilotSources& sources) {
  // An autopilot has its own files and none of those that gatefly comes with: default.toml only says
  // what the program's own defaults are.
  std::vector<std::filesystem::path> files;
  if (files::shipped_dir().empty())
    for (const std::string& name : sources.configs) files.push_back(files::find_config(name));
  else
    files = config_files(sources.configs);
  std::optional<TextFile> text;
  if (!sources.config_text.empty()) text = TextFile{"config text", sources.config_text};
  const Config config = load_config(files, sources.settings, text);
  const TrackFile file = sources.track.empty()
                             ? read_track(TextFile{"track text", sources.track_text}, config.gate)
                             : read_track(find_track(sources.track), config.gate);
  PilotFiles read{on_course(config, file).pilot, config.camera.stored_width(),
                  config.camera.stored_height(), config.camera.stored_rotation_deg};
  read.pilot.track = file.track;
  return read;
}

}  // namespace gatefly::config
