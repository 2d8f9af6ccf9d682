// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/config/schema.hpp"
#include "gatefly/race/pilot.hpp"
#include "gatefly/sim/sim_config.hpp"

namespace gatefly::io {

/// Everything that [sections] of configuration files set, ready to use. Keys: config_keys.cpp.
///
/// Values that a team measures ([camera], [vehicle]) are what the pilot believes *and* what the
/// simulator varies around; nothing ever goes from the simulator to the pilot.
struct Config {
  PilotConfig pilot;              ///< Its track is empty: that comes from a track file.
  sim::SimConfig sim;             ///< Nominal; its world is empty, nothing is drawn yet.
  int stored_rotation_deg = 90;   ///< Counter-clockwise turn that makes a stored picture upright.
  int width = 315, height = 160;  ///< Of the upright picture [px].
  std::string camera_model = "dhane";
  Eigen::Vector2d focal_px = DhaneFisheye{}.focal_px, center_px = DhaneFisheye{}.center_px;
  std::vector<double> distortion{DhaneFisheye{}.k};  ///< The model's coefficients, in its order.
  double camera_latency = 0.030;                     ///< From the end of read-out to arrival [s].
  Eigen::Vector3d gate_rgb{1.0, 0.4, 0.0};  ///< What a gate looks like, sRGB 0..1; its hue counts.
  /// File of a fitted colour model, in place of gate_rgb; "": none. From the working directory.
  std::string color_table;
  double gate_side = 1.0, gate_bar = 0.05;  ///< Where a file names none [m].
  std::string gate_corners = "outer";       ///< What labels and detections mean.
  /// "paper", "flown": Li18's two, with their own colours and numbers.
  std::string detector_mode = "ours";
  std::string control_mode = "ours";
  double timeout = 240.0;                               ///< Of one simulated flight [s].
  nlohmann::json randomize = nlohmann::json::object();  ///< Put over the track's [randomize].
  std::vector<std::string> notes;  ///< Lines about keys that have no effect any more.
  /// Key -> file or "--set"; others have their default.
  std::map<std::string, std::string> set_by;

  Config();
  [[nodiscard]] int stored_width() const { return stored_rotation_deg % 180 == 0 ? width : height; }
  [[nodiscard]] int stored_height() const {
    return stored_rotation_deg % 180 == 0 ? height : width;
  }
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

}  // namespace gatefly::io
