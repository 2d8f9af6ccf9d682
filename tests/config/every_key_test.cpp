// SPDX-License-Identifier: Apache-2.0
// What holds for each key of the configuration, whichever they are.
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/config/config.hpp"
#include "gatefly/config/faults.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/files/color_model_file.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::config {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Files = std::vector<std::filesystem::path>;
using Settings = std::vector<std::string>;
using Values = std::map<std::string, json>;  // "section.key" -> value

Values flat(const json& sections) {
  Values values;
  for (const auto& [section, table] : sections.items())
    for (const auto& [key, value] : table.items()) values[section + "." + key] = value;
  return values;
}

Values loaded(const Settings& settings) { return flat(as_json(load_config(Files{}, settings))); }

/// The keys that have another value, or are new.
std::set<std::string> changed(const Values& before, const Values& after) {
  std::set<std::string> names;
  for (const auto& [name, value] : after)
    if (!before.contains(name) || before.at(name) != value) names.insert(name);
  return names;
}

std::vector<KeyRule> every_rule() {
  std::vector<KeyRule> rules;
  for (const auto& key : config_keys()) rules.push_back(key.rule);
  for (const auto& key : randomize_keys()) rules.push_back(key.rule);
  for (const auto& key : fault_keys()) rules.push_back(key.rule);
  return rules;
}

/// A hundredth more, or less where more is not allowed.
json nudged(const json& now, const KeyRule& rule, bool whole) {
  const double x = now.get<double>();
  const double step = whole ? 1.0 : x == 0.0 ? 1e-3 * (rule.high - rule.low) : 0.01 * std::abs(x);
  const double other = x + step <= rule.high ? x + step : x - step;
  return whole ? json(static_cast<int>(other)) : json(std::stod(files::text_of(other, 9)));
}

/// 0, or 25 and more, and then with a filter of ours only.
bool is_autopilots_rate(const std::string& name) {
  return name == "filter.imu_hz" || name == "sim.autopilot_imu_hz";
}

/// A value that the key may have and has not; null for a key of one choice.
json another(const KeyRule& rule, const json& now, const std::string& color_table) {
  if (rule.name == "camera.stored_rotation_deg") return now == 180 ? 90 : 180;
  if (is_autopilots_rate(rule.name)) return now == 100 ? 50 : 100;
  switch (rule.kind) {
    case KeyRule::Kind::kFile:
      return color_table;
    case KeyRule::Kind::kText:
      for (const std::string& choice : rule.choices)
        if (choice != now) return choice;
      return nullptr;
    case KeyRule::Kind::kNumbers: {
      json list = json::array();
      for (const json& each : now) list.push_back(nudged(each, rule, rule.whole));
      return list;
    }
    case KeyRule::Kind::kInteger:
      return nudged(now, rule, true);
    case KeyRule::Kind::kNumber:
    case KeyRule::Kind::kNumberOrList:
      break;
  }
  return nudged(now, rule, false);
}

/// Values that the key may not have.
std::vector<json> not_allowed(const KeyRule& rule) {
  const json below = rule.low - 1.0, above = rule.high + 1.0;
  const auto list_with = [&](const json& one) {
    json list(rule.count, rule.low);
    list.back() = one;
    return list;
  };
  switch (rule.kind) {
    case KeyRule::Kind::kFile:
      return {3, true, json::array()};
    case KeyRule::Kind::kText:
      return {"none of them", 3, true, json::array()};
    case KeyRule::Kind::kNumbers:
      return {list_with(below),
              list_with(above),
              list_with("much"),
              json(rule.count + 1, rule.low),
              json::array(),
              "much",
              true};
    case KeyRule::Kind::kNumberOrList:
      return {below,  above, list_with(below), list_with("much"), json(rule.count + 1, rule.low),
              "much", true};
    case KeyRule::Kind::kInteger:
      return {below, above, rule.low + 0.5, "much", true, json::array()};
    case KeyRule::Kind::kNumber:
      break;
  }
  return {below, above, "much", true, json::array()};
}

std::string section_of(const std::string& name) { return name.substr(0, name.find('.')); }
std::string key_of(const std::string& name) { return name.substr(name.find('.') + 1); }

class EveryKey : public ::testing::Test {
 protected:
  const test::TempFolder folder_;
  const std::string color_table_ =
      folder_.file("colors.toml", files::color_model_text(ColorModel::described({0, 0, 1}), "blue"))
          .string();

  /// Other value of a key that `before` lacks, the track's: 0, or the least that is allowed.
  json other_value(const KeyRule& rule, const Values& before) const {
    const json of_track = rule.kind == KeyRule::Kind::kNumbers ? json(rule.count, 0.0)
                                                               : json(std::max(0.0, rule.low));
    return another(rule, before.contains(rule.name) ? before.at(rule.name) : of_track,
                   color_table_);
  }
};

TEST_F(EveryKey, SetAloneChangesItsOwnValueAndNoOther) {
  const Values before = loaded({});
  for (const KeyRule& rule : every_rule()) {
    SCOPED_TRACE(rule.name);
    const json value = other_value(rule, before);
    if (value.is_null()) {
      EXPECT_EQ(rule.choices.size(), 1u);
      continue;
    }
    const Values after = loaded({rule.name + "=" + value.dump()});
    EXPECT_EQ(changed(before, after), std::set{rule.name});
    EXPECT_EQ(after.at(rule.name), value);
  }
}

TEST_F(EveryKey, OfRandomizeChangesOneDeviationAndNoOther) {
  const auto deviations = [](const json& table) {
    const auto drawn_with = randomized({}, table, "here");
    Values values;
    for (const auto& key : randomize_keys()) values[key.rule.name] = key.get(drawn_with);
    return values;
  };
  const Values before = deviations(json::object());
  for (const auto& key : randomize_keys()) {
    const std::string& name = key.rule.name;
    const json value = other_value(key.rule, before);
    const Values after = deviations({{key_of(name), value}});
    // Where it stands alone, camera_k is of every lens, as it was when it was the only one.
    const bool both = name == "randomize.camera_k";
    EXPECT_EQ(changed(before, after),
              both ? std::set<std::string>({name, "randomize.camera_k1_percent"}) : std::set{name});
    EXPECT_EQ(after.at(name), value) << name;
  }
}

TEST_F(EveryKey, OfLensesIsItsOwnWhereBothAreNamed) {
  const auto both = randomized({}, {{"camera_k", 0.02}, {"camera_k1_percent", 13.0}}, "here");
  EXPECT_EQ(both.camera_k, 0.02);
  EXPECT_EQ(both.camera_k1, 0.13);
  EXPECT_EQ(randomized({}, {{"camera_k1_percent", 13.0}}, "here").camera_k, 0.0);
}

TEST_F(EveryKey, CameraKAloneIsOfEveryLens) {
  world::Randomize of_a_track;
  of_a_track.camera_k1 = 0.13;
  EXPECT_EQ(randomized(of_a_track, {{"camera_k", 0.1}}, "here").camera_k1, 0.1);
}

TEST_F(EveryKey, RefusesWhatItMayNotHoldNamingFileKeyAndValue) {
  for (const KeyRule& rule : every_rule())
    for (const json& value : not_allowed(rule)) {
      const auto file =
          folder_.file("mine.toml", "[" + section_of(rule.name) + "]\n" + key_of(rule.name) +
                                        " = " + value.dump() + "\n");
      EXPECT_THAT(test::error_of([&] { (void)load_config(Files{file}); }),
                  HasSubstr(file.string() + ":2: " + rule.name + " = " + files::shown(value) +
                            ", must be "));
    }
}

TEST_F(EveryKey, IsShownOnceInItsSectionAndStandsOnceInTheJson) {
  const Config config = load_config(Files{});
  std::map<std::string, int> lines;
  std::istringstream text{show(config)};
  std::string section;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("[")) section = line.substr(1, line.find(']') - 1);
    if (line.find('=') != std::string::npos) {
      const auto key = line.substr(line.starts_with("# ") ? 2 : 0);
      ++lines[section + "." + key.substr(0, key.find(' '))];
    }
  }
  const Values json_values = flat(as_json(config));
  for (const KeyRule& rule : every_rule()) {
    EXPECT_EQ(lines[rule.name], 1) << rule.name;
    const bool is_tracks =
        section_of(rule.name) == "randomize" || section_of(rule.name) == "faults";
    EXPECT_EQ(json_values.contains(rule.name), !is_tracks) << rule.name;
  }
  EXPECT_EQ(lines["randomize.level"], 1);
  EXPECT_EQ(lines.size(), every_rule().size() + 1);
  EXPECT_EQ(json_values.size(), config_keys().size());
}

/// The members behind the keys that have another unit than SI.
std::vector<double> converted(const Config& c) {
  const PilotConfig& p = c.pilot;
  return {c.camera.tilt_down,
          c.camera.latency,
          c.camera.readout,
          c.camera.exposure,
          p.gate_yaw_sigma,
          p.pose.attitude_sigma,
          p.pose.heading_sigma,
          p.ahrs.start_heading_sigma,
          p.filter_memory,
          p.paper_control.pitch,
          p.lateral.max_roll,
          p.speed.max_pitch,
          p.speed.min_pitch,
          p.speed.roll_lead,
          p.speed.brake_lead,
          p.look_aside.most,
          p.phase.max_tilt,
          p.phase.imu_timeout,
          c.vehicle.rotor_time_constant,
          c.sim.ideal_vision.outliers,
          c.sim.vehicle.rotor_time_constant,
          c.sim.sensors.imu_jitter,
          c.sim.sensors.autopilot_imu_jitter};
}

/// 0.06 rad is 3.437746770784939 degrees in a file, not some digits fewer.
TEST_F(EveryKey, ReadsBackToTheSameBits) {
  for (const Settings& each :
       {Settings{}, Settings{"camera.tilt_deg=16.1", "camera.latency_ms=9.7"}}) {
    const Config config = load_config(Files{}, each);
    const Config again = load_config(Files{folder_.file("shown.toml", show(config))});
    EXPECT_EQ(converted(again), converted(config));
    EXPECT_EQ(as_json(again), as_json(config));
  }
}

/// The output of show() is a configuration file; the track's own values are comments in it.
TEST_F(EveryKey, AsShownReadsBackAsItself) {
  const Values before = loaded({});
  Settings settings{"camera.model=brown-conrady", "camera.distortion=[-0.3, 0.1, 0.002, 0, 0.05]"};
  for (const KeyRule& rule : every_rule())
    if (const json value = other_value(rule, before);
        rule.name != "camera.model" && rule.name != "camera.distortion" &&
        !is_autopilots_rate(rule.name) && !value.is_null())
      settings.push_back(rule.name + "=" + value.dump());
  for (const Settings& each : {Settings{}, settings}) {
    const Config config = load_config(Files{}, each);
    const Config again = load_config(Files{folder_.file("shown.toml", show(config))});
    EXPECT_EQ(as_json(again), as_json(config));
    EXPECT_EQ(again.set_by.size(),
              config_keys().size() + config.randomize.size() + config.faults.size());
    EXPECT_THAT(again.notes, IsEmpty());
  }
}

}  // namespace
}  // namespace gatefly::config
