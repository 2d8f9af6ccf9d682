// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include "gatefly/config/check_config.hpp"
#include "gatefly/config/derived.hpp"
#include "gatefly/config/faults.hpp"
#include "gatefly/config/key_names.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/config/texts.hpp"
#include "gatefly/files/color_model_file.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"

namespace gatefly::config {
namespace {

using nlohmann::json;

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  return first == std::string::npos ? ""
                                    : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<std::string> section_names() {
  std::set<std::string> sections;
  for (const std::string& name : key_names()) sections.insert(name.substr(0, name.find('.')));
  return {sections.begin(), sections.end()};
}

/// A file named in another is looked for beside it; named by --set (file ""), where it says.
std::string beside(const std::filesystem::path& file, const std::string& name) {
  if (name.empty() || file.empty()) return name;
  return (file.parent_path() / name).lexically_normal().string();
}

/// Keys that were renamed, by their old names, which still work.
const std::map<std::string, std::string>& renamed_keys() {
  static const std::map<std::string, std::string> renamed{
      {"pose.white_px", "pose.random_sigma_px"},
      {"pose.white_part_px", "pose.random_part_sigma_px"},
      {"sim.ghosts_percent", "sim.outliers_percent"}};
  return renamed;
}

std::string current_name(const std::string& name) {
  const auto found = renamed_keys().find(name);
  return found == renamed_keys().end() ? name : found->second;
}

/// Keys of the colour box and of the searches that used it: known, so that older files still load.
bool is_retired(const std::string& name) {
  static const std::set<std::string> retired{"color.y_min",
                                             "color.y_max",
                                             "color.cb_min",
                                             "color.cb_max",
                                             "color.cr_min",
                                             "color.cr_max",
                                             "color.min_chroma",
                                             "detector.open_samples",
                                             "detector.open_min_width_px",
                                             "detector.bars_min_height",
                                             "detector.bars_min_ratio",
                                             "detector.bars_smoothing_px",
                                             "detector.bars_min_gap_px"};
  return retired.contains(name);
}

void set_key(Config& config, const std::string& given, const json& value, const std::string& where,
             const std::filesystem::path& file = {}) {
  const std::string name = current_name(given);
  if (name != given) config.notes.push_back(where + ": " + given + " is the old name of " + name);
  if (is_retired(name)) {
    config.notes.push_back(
        where + ": " + name +
        " has no effect any more: color.rgb or color.table says what a gate looks like");
    return;
  }
  if (name.starts_with("randomize.")) {
    check_randomize(name.substr(10), value, where);
    config.randomize[name.substr(10)] = value;
  } else if (name.starts_with("faults.")) {
    check_fault(name.substr(7), value, where);
    config.faults[name.substr(7)] = value;
  } else {
    const auto& keys = config_keys();
    const auto found = std::find_if(keys.begin(), keys.end(),
                                    [&](const auto& key) { return key.rule.name == name; });
    if (found == keys.end())
      throw std::runtime_error(where + ": " + files::one_line(name) + " is not a known key" +
                               key_suggestion(name));
    json allowed = checked(found->rule, value, where);
    if (found->rule.kind == KeyRule::Kind::kFile)
      allowed = beside(file, allowed.get<std::string>());
    found->set(config, allowed);
  }
  config.set_by[name] = where;
}

[[noreturn]] void unknown_section(const std::string& section, const json& content,
                                  const std::string& place) {
  const std::string where = place + ": ";
  if (!content.is_object())
    throw std::runtime_error(where + files::one_line(section) + " stands outside every [section]" +
                             key_suggestion(section));
  throw std::runtime_error(where + "[" + files::one_line(section) + "] is not a known section" +
                           files::suggestion(section, section_names()) +
                           " (there are: " + files::joined(section_names()) + ")");
}

void read_config_file(Config& config, const files::TomlFile& file,
                      const std::filesystem::path& path) {
  for (const auto& [section, table] : file.content().items()) {
    const std::string pointer = "/" + section, place = file.place(pointer);
    const auto sections = section_names();
    if (std::find(sections.begin(), sections.end(), section) == sections.end())
      unknown_section(section, table, place);
    if (!table.is_object())
      throw std::runtime_error(place + ": " + section + " = " + files::shown(table) +
                               ", must be a section: [" + section +
                               "] on a line of its own, its keys below");
    for (const auto& [key, value] : table.items()) {
      const std::string name = section + "." + key, now = current_name(name);
      const std::string where = file.place(pointer + "/" + key);
      if (now != name && table.contains(now.substr(section.size() + 1)))
        throw std::runtime_error(where + ": " + name + " is the old name of " + now +
                                 ", which is set, too: keep one of them");
      set_key(config, name, value, where, path);
    }
  }
}

/// `low` may not be above `high`, wherever they were set.
void ordered(const Config& config, const char* low_key, double low, const char* high_key,
             double high) {
  if (low <= high) return;
  const auto who = config.set_by.contains(low_key)    ? config.set_by.at(low_key)
                   : config.set_by.contains(high_key) ? config.set_by.at(high_key)
                                                      : "default";
  throw std::runtime_error(who + ": " + low_key + " = " + files::text_of(low) +
                           ", must be at most " + high_key + " = " + files::text_of(high));
}

/// Requirements of a model on camera.distortion.
struct LensRule {
  std::string model;
  std::vector<std::string> coefficients;
  double low, high;
};

const LensRule& lens_rule(const std::string& model) {
  static const std::array<LensRule, 4> rules{
      {{"dhane", {"k"}, 0.5, 2},
       {"pinhole", {}, 0, 0},
       {"brown-conrady", {"k1", "k2", "p1", "p2", "k3"}, -1000, 1000},
       {"kannala-brandt", {"k1", "k2", "k3", "k4"}, -1000, 1000}}};
  return *std::find_if(rules.begin(), rules.end() - 1,
                       [&](const LensRule& rule) { return rule.model == model; });
}

void check_distortion(const Config& c) {
  const LensRule& rule = lens_rule(c.camera.model);
  const bool given = c.set_by.contains("camera.distortion");
  if (!given && rule.coefficients.empty()) return;  // the default is Dhane's k
  const bool fits = c.camera.distortion.size() == rule.coefficients.size() &&
                    std::all_of(c.camera.distortion.begin(), c.camera.distortion.end(),
                                [&](double each) { return each >= rule.low && each <= rule.high; });
  if (fits) return;
  const std::string need = rule.coefficients.empty()
                               ? "[]"
                               : std::to_string(rule.coefficients.size()) + " number" +
                                     (rule.coefficients.size() == 1 ? "" : "s") + " [" +
                                     files::joined(rule.coefficients) + "] in " +
                                     files::text_of(rule.low) + ".." + files::text_of(rule.high);
  throw std::runtime_error(c.set_by.at(given ? "camera.distortion" : "camera.model") +
                           ": camera.distortion = " + files::shown(json(c.camera.distortion)) +
                           (given ? "" : " (the default)") + ", must be " + need +
                           " with camera.model = \"" + c.camera.model + "\"");
}

/// An autopilot's IMU comes as often as a filter of ours can use it, not more often than the vehicle's.
void check_autopilot_imu(const Config& c) {
  constexpr double kSlowest = 25.0;  // [Hz]
  const auto fail = [&](const std::string& key, double value, const std::string& must) {
    const auto who = c.set_by.find(key);
    throw std::runtime_error((who == c.set_by.end() ? "default" : who->second) + ": " + key +
                             " = " + files::text_of(value) + ", must be " + must);
  };
  const double vehicle_hz = c.rates.imu_hz;
  const std::string vehicle = "vehicle.imu_hz = " + files::text_of(vehicle_hz);
  const world::SensorTruth& sim = c.sim.sensors;
  for (const auto& [key, hz] : {std::pair{"filter.imu_hz", c.rates.filter_imu_hz},
                                std::pair{"sim.autopilot_imu_hz", sim.autopilot_imu_hz}}) {
    if (!(hz > 0.0)) continue;
    if (hz < kSlowest) fail(key, hz, "0 or in 25..512");
    if (hz > vehicle_hz) fail(key, hz, "at most " + vehicle);
    if (c.filter_model != "ours")
      fail(key, hz, "0 with filter.model = \"" + c.filter_model + "\", which takes every sample");
    if (c.pose_model != "ours")
      fail(key, hz,
           "0 with pose.model = \"" + c.pose_model + "\", whose filter takes every sample");
  }
  if (!(sim.autopilot_imu_hz > 0.0)) return;
  for (const auto& [key, cutoff] :
       {std::pair{"sim.autopilot_gyro_cutoff_hz", sim.autopilot_gyro_cutoff},
        std::pair{"sim.autopilot_accel_cutoff_hz", sim.autopilot_accel_cutoff}})
    if (!(cutoff < 0.5 * vehicle_hz)) fail(key, cutoff, "less than half of " + vehicle);
}

void check(const Config& c) {
  check_distortion(c);
  check_autopilot_imu(c);
  ordered(c, "pose.min_bars_distance_m", c.pilot.pose.min_bars_distance, "pose.max_bars_distance_m",
          c.pilot.pose.max_bars_distance);
  ordered(c, "vehicle.min_rotor_radps", c.vehicle.min_speed, "vehicle.max_rotor_radps",
          c.vehicle.max_speed);
  ordered(c, "sim.battery_empty_v", c.sim.vehicle.battery.empty, "sim.battery_full_v",
          c.sim.vehicle.battery.full);
  const auto who = [&](const char* key) {
    return c.set_by.contains(key) ? c.set_by.at(key) : std::string{"default"};
  };
  if (c.gate.bar * 2 >= c.gate.side)
    throw std::runtime_error(
        who("gate.bar_m") + ": gate.bar_m = " + files::text_of(c.gate.bar) +
        ", must be less than half of gate.side_m = " + files::text_of(c.gate.side));
  if (c.camera.stored_rotation_deg % 90 != 0)
    throw std::runtime_error(who("camera.stored_rotation_deg") + ": camera.stored_rotation_deg = " +
                             std::to_string(c.camera.stored_rotation_deg) +
                             ", must be 0, 90, 180 or 270");
}

void read_color_table(Config& c) {
  if (c.gate.color_table.empty()) return;
  try {
    c.gate.fitted_color = files::read_color_model(c.gate.color_table);
  } catch (const std::exception& error) {
    throw std::runtime_error(c.set_by.at("color.table") + ": color.table: " + error.what());
  }
}

}  // namespace

Config::Config() { pilot = pilot_config(*this); }

Config load_config(std::span<const std::filesystem::path> files,
                   std::span<const std::string> settings) {
  return load_config(files, settings, std::nullopt);
}

Config load_config(std::span<const std::filesystem::path> files,
                   std::span<const std::string> settings, const std::optional<TextFile>& text) {
  Config config;
  for (const auto& file : files) read_config_file(config, files::TomlFile{file}, file);
  if (text) read_config_file(config, files::TomlFile{text->name, text->content}, {});
  for (const std::string& setting : settings) {
    if (setting.find_first_of("\n\r") != std::string::npos)  // a flight keeps each on a line
      throw std::runtime_error("--set " + files::one_line(setting) + ": must be on one line");
    const auto equals = setting.find('=');
    const std::string name = trimmed(setting.substr(0, equals));
    if (equals == std::string::npos || name.empty())
      throw std::runtime_error("--set " + files::one_line(setting) + ": must be section.key=value");
    set_key(config, name, files::parse_toml_value(setting.substr(equals + 1)), "--set");
  }
  check(config);
  read_color_table(config);
  config.pilot = pilot_config(config);
  return config;
}

void check_config(const std::string& content, const std::string& name) {
  Config config;
  read_config_file(config, files::TomlFile{name, content}, name);
  check(config);
  (void)pilot_config(config);
}

std::vector<std::filesystem::path> config_files(std::span<const std::string> names) {
  std::vector<std::filesystem::path> files{files::find_toml("default", "configs")};
  for (const std::string& name : names) files.push_back(files::find_config(name));
  return files;
}

json as_json(const Config& config) {
  json result = json::object();
  for (const auto& key : config_keys()) {
    const auto dot = key.rule.name.find('.');
    result[key.rule.name.substr(0, dot)][key.rule.name.substr(dot + 1)] = key.get(config);
  }
  result["randomize"] = config.randomize;
  result["faults"] = config.faults;
  return result;
}

json with_current_names(json config) {
  for (const auto& [old_name, name] : renamed_keys()) {
    const auto dot = old_name.find('.');
    const std::string section = old_name.substr(0, dot), old_key = old_name.substr(dot + 1);
    if (!config.is_object() || !config.contains(section) || !config[section].is_object() ||
        !config[section].contains(old_key))
      continue;
    const json value = config[section][old_key];
    config[section].erase(old_key);
    config[section][name.substr(dot + 1)] = value;
  }
  return config;
}

}  // namespace gatefly::config
