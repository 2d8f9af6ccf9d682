// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/pilot_files.hpp"

#include "gatefly/config/config.hpp"
#include "gatefly/config/derived.hpp"
#include "gatefly/config/track_file.hpp"

namespace gatefly::io {

PilotConfig read_pilot_config(const std::string& track, const std::vector<std::string>& configs,
                              const std::vector<std::string>& settings) {
  const Config config = load_config(config_files(configs), settings);
  const TrackFile file = read_track(find_track(track), config.gate);
  PilotConfig pilot = on_course(config, file).pilot;
  pilot.track = file.track;
  return pilot;
}

}  // namespace gatefly::io
