// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/flight_log/recording.hpp"
#include "gatefly/flight_log/replay.hpp"
#include "gatefly/tasks/arguments.hpp"

namespace gatefly::tasks {

/// Arguments for flying a recorded flight again.
struct ReplayArguments {
  ConfigArguments config;
  std::string directory;  ///< log_si.csv, images.csv, pictures.
  std::string track;      ///< Instead of the folder's own: a name or a file; "": none.
  std::string data;       ///< Root for directories that are not here; "": default.
  /// "drag", "eskf", "imu15": whose estimates; "": those of the filter that the flight is configured with.
  std::string estimator;
  /// Real logs: the map's heading minus the log's own, where somebody knows it [deg].
  double heading_offset_deg = 0.0;
  /// A log without sonar and barometer gets its height from its true positions.
  bool true_height = false;
};

/// A recorded flight, ready for the pilot.
struct RecordedFlight {
  config::Config config;
  PilotConfig pilot;
  flight_log::FlightFolder folder;
  std::filesystem::path track_file;  ///< The pilot's track comes from.
  std::vector<flight_log::RecordedTick> ticks;
  /// As they stand, in the map's order: of a simulated flight what its summary says, of a real one the
  /// map, which nobody knows better. Empty: an older flight, which does not say.
  std::vector<MapGate> true_gates;
  flight_log::Pictures pictures = flight_log::Pictures::kNone;  ///< Place of the pictures.
  bool simulated = false;  ///< Flown by `gatefly fly`: carries its own track and configuration.
  std::vector<std::string> notes;  ///< Remarks of the configuration to its user.
};

/// The names of estimators that may be asked for.
[[nodiscard]] const std::vector<std::string>& estimator_names();

/// Estimator of a replay: the one asked for, else the one that the configuration flies.
[[nodiscard]] std::string estimator_of(const ReplayArguments& arguments, const PilotConfig& pilot);

/// @throws std::runtime_error one line: unreadable, damaged, not whole.
[[nodiscard]] RecordedFlight read_flight(const ReplayArguments& arguments);

/// How pictures that were not kept are rendered again: simulated_race/rendered_again.hpp. A gatefly
/// without the simulator has nobody for it. The second is called now and then and may throw to stop.
using RenderAgain =
    std::function<flight_log::PictureSource(const RecordedFlight&, const std::function<void()>&)>;

/// Flies it again, by the pilot or the filter that was asked for.
/// @param on_picture  called before each picture is read, and often while a room's light is baked for
///     them; may throw to stop; may be empty.
/// @param on_tick  called after every step; may be empty.
/// @throws std::runtime_error one line: a picture cannot be read, the track cannot be flown.
[[nodiscard]] flight_log::ReplayResult replayed(
    const RecordedFlight& flight, const ReplayArguments& arguments,
    const std::function<void()>& on_picture = {}, const RenderAgain& render_again = {},
    const std::function<void(const flight_log::ReplayedTick&)>& on_tick = {});

}  // namespace gatefly::tasks
