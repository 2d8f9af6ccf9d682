// SPDX-License-Identifier: Apache-2.0
#include "drone_options.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "gatefly/config/config.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"

namespace gatefly::cli {
namespace {

constexpr const char* kSpeed = "control.speed_mps";

const config::KeyRule& speed_rule() {
  const auto& keys = config::config_keys();
  return std::find_if(keys.begin(), keys.end(),
                      [](const auto& key) { return key.rule.name == kSpeed; })
      ->rule;
}

/// The file that a name in `folder` or a path stands for; it must have the [section] it is given for.
std::string described_by(const std::string& name, const std::string& folder,
                         const std::string& section) {
  const std::filesystem::path file = files::find_toml(name, folder);
  if (!files::TomlFile(file).content().contains(section))
    throw std::runtime_error("--" + section + " " + files::one_line(name) + ": has no [" + section +
                             "]; what else a configuration sets is for --config");
  std::error_code error;
  const bool is_file = std::filesystem::exists(name, error) || name.ends_with(".toml");
  return is_file ? name : folder + "/" + name + ".toml";
}

}  // namespace

void add_drone(Command& command, DroneOptions& options) {
  command
      .option("--camera", options.camera,
              "a name in cameras/ or a file with a [camera]; goes over --config")
      .type_name("CAMERA")
      .path();
  command
      .option("--vehicle", options.vehicle,
              "a name in vehicles/ or a file with a [vehicle]; goes over --config")
      .type_name("VEHICLE")
      .path();
}

void add_speed(Command& command, DroneOptions& options) {
  command.option("--speed", options.speed, "on straights [m/s]: control.speed_mps")
      .between(speed_rule().low, speed_rule().high)
      .type_name("MPS");
}

void take_drone(const DroneOptions& drone, tasks::ConfigArguments& config) {
  if (!drone.camera.empty())
    config.configs.push_back(described_by(drone.camera, "cameras", "camera"));
  if (!drone.vehicle.empty())
    config.configs.push_back(described_by(drone.vehicle, "vehicles", "vehicle"));
  if (!drone.speed) return;
  const std::string speed = "--speed " + files::text_of(*drone.speed);
  for (const std::string& setting : config.settings)
    if (setting.find(kSpeed) == setting.find_first_not_of(" \t"))
      throw std::runtime_error(speed + " and --set " + files::one_line(setting) +
                               ": give one of them");
  config.settings.push_back(std::string{kSpeed} + "=" + files::text_of(*drone.speed));
}

}  // namespace gatefly::cli
