// SPDX-License-Identifier: Apache-2.0
// Recorded flights, simulated and real, through the pilot.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/flight_log/recording.hpp"
#include "gatefly/flight_log/replay.hpp"
#include "gatefly/geometry/math.hpp"

#include "support/real_data.hpp"

namespace gatefly::support {

inline std::filesystem::path real_flights() { return real_data() / "tudelft_bebop_flights"; }

inline flight_log::ReplayResult replayed(const PilotConfig& pilot,
                                         const flight_log::FlightFolder& folder,
                                         const config::Config& config,
                                         flight_log::Estimator estimator) {
  const auto load =
      flight_log::upright(flight_log::pictures_in_files(folder, config.camera.stored_width(),
                                                        config.camera.stored_height()),
                          config.camera.stored_rotation_deg);
  return flight_log::replay(pilot, flight_log::ticks_of(folder, flight_log::SonarStandIn{}), load,
                            estimator);
}

/// A real flight as the drag filter needs it told: heading from its own AHRS plus the offset to motion
/// capture, height from motion capture, the tilt and the map that were fitted to flight 11.
inline flight_log::ReplayResult replayed_real(
    const std::filesystem::path& directory, double heading_offset_deg,
    flight_log::Estimator estimator = flight_log::Estimator::kDrag) {
  const config::Config config =
      config::load_config(config::config_files(std::vector<std::string>{"flights"}));
  const flight_log::FlightFolder folder = flight_log::read_flight_folder(directory);
  PilotConfig pilot = config.pilot;
  pilot.track = config::read_track(config::find_track("flights")).track;
  pilot.track.gates.front().p_EG = {4.15, 0.73, -1.36};
  pilot.track.gates.front().yaw_EG = 0.0;
  pilot.camera.R_BC = camera_mount(13.3 * kDegree);
  pilot.ahrs.start_heading_sigma = AhrsParams{}.start_heading_sigma;
  pilot.filter.start_sigma = DragFilterParams{}.start_sigma;
  pilot.gate_yaw_sigma = PilotConfig{}.gate_yaw_sigma;
  pilot.track.start_heading =
      wrap_angle(folder.samples.front().ahrs.value().yaw + heading_offset_deg * kDegree);
  return replayed(pilot, folder, config, estimator);
}

/// A simulated flight carries its own configuration and track.
inline config::Config config_of(const std::filesystem::path& directory) {
  return config::load_config(std::vector<std::filesystem::path>{directory / "config-0.toml"});
}
/// The pilot that flew one lap of it.
inline PilotConfig pilot_of(const config::Config& config, const std::filesystem::path& directory) {
  PilotConfig pilot = config.pilot;
  pilot.track = config::read_track(directory / "track.toml").track;
  pilot.track.laps = 1;
  return pilot;
}

inline flight_log::ReplayResult replayed_simulated(
    const std::filesystem::path& directory,
    flight_log::Estimator estimator = flight_log::Estimator::kDrag) {
  const config::Config config = config_of(directory);
  return replayed(pilot_of(config, directory), flight_log::read_flight_folder(directory), config,
                  estimator);
}

}  // namespace gatefly::support
