// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/config/descriptions.hpp"
#include "gatefly/config/schema.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/race/pilot.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::config {

/// [sim]: the simulator's own. What it shares with the pilot: simulator_config in derived.hpp.
struct SimulatorSettings {
  world::VehicleTruth vehicle;
  /// True moments of inertia / the vehicle file's. [recorded flights: docs/simulation.md]
  Eigen::Vector3d inertia_ratio{1.0, 2.75, 1.0};
  world::SensorTruth sensors;
  world::AutopilotTruth autopilot;
  world::Wind wind;
  world::Imaging imaging;
  world::GatePaint paint;
  world::IdealVisionParams ideal_vision;
  std::string camera_quality = "full";  ///< Or "fast": one ray a pixel, no blur, no glare.
  int bake_threads = 2;
  double timeout = 240.0;  ///< Limit of one flight [s].
};

/// Everything that [sections] of configuration files set. Keys: config_keys.cpp.
struct Config {
  CameraDescription camera;
  VehicleDescription vehicle;
  SensorRates rates;
  GateDescription gate;
  /// Ready to use, as pilot_config in derived.hpp makes it; its track is empty: that comes from a
  /// track file.
  PilotConfig pilot;
  SimulatorSettings sim;
  /// Method of each stage: detector.mode ("paper", "flown": Li18's two, with their own colours and
  /// numbers), pose.model, filter.model, control.mode.
  std::string detector_mode = "ours";
  std::string pose_model = "ours", filter_model = "ours", control_mode = "ours",
              indi_effectiveness = "fixed", output = "motors";
  /// The angle that a lens nobody named shows across the picture, as `tune` found it: equidistant_lens().
  /// Below 0: unknown.
  double lens_angle = -kDegree;
  Eigen::Vector2d lens_center{0, 0};
  nlohmann::json randomize = nlohmann::json::object();  ///< Put over the track's [randomize].
  nlohmann::json faults = nlohmann::json::object();     ///< Put over the track's [faults].
  std::vector<std::string>
      notes;  ///< Lines about keys that were renamed or have no effect any more.
  /// Key -> "file:line" or "--set"; others have their default.
  std::map<std::string, std::string> set_by;

  Config();
};

/// The one table of all keys but [randomize]'s, in the order they are shown.
[[nodiscard]] const std::vector<Key<Config>>& config_keys();

/// Defaults, then each file over the last, then each "section.key=value".
/// @throws std::runtime_error naming file, key, value and what is allowed; for an unknown key the
///     nearest.
[[nodiscard]] Config load_config(std::span<const std::filesystem::path> files,
                                 std::span<const std::string> settings = {});

/// configs/default.toml of ./configs or the source tree, then `names`: paths, or names in configs/.
[[nodiscard]] std::vector<std::filesystem::path> config_files(std::span<const std::string> names);

/// Every key with its value, unit, who set it, and the default's source; one line each. As a file
/// it loads as the same configuration: what the track decides is a comment.
[[nodiscard]] std::string show(const Config& config);

/// {section: {key: value}}, effective values.
[[nodiscard]] nlohmann::json as_json(const Config& config);

/// Translates as_json() of an earlier version: renamed keys get their present names.
[[nodiscard]] nlohmann::json with_current_names(nlohmann::json config);

}  // namespace gatefly::config
