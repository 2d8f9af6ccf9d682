// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/json_schema.hpp"

#include <string>
#include <string_view>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/config/faults.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/config/track_keys.hpp"
#include "gatefly/files/toml_file.hpp"

namespace gatefly::config {
namespace {

using nlohmann::ordered_json;

ordered_json number(const char* type, double low, double high) {
  return {{"type", type}, {"minimum", low}, {"maximum", high}};
}

ordered_json list_of(const ordered_json& items, std::size_t least, std::size_t most) {
  return {{"type", "array"}, {"items", items}, {"minItems", least}, {"maxItems", most}};
}

ordered_json one_of_words(const std::vector<std::string>& choices) {
  return {{"type", "string"}, {"enum", choices}};
}

/// A table that holds these keys and no others.
ordered_json table(const ordered_json& properties) {
  return {{"type", "object"}, {"additionalProperties", false}, {"properties", properties}};
}

ordered_json document(const char* title, ordered_json content) {
  ordered_json schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
  schema.update(content);
  return schema;
}

ordered_json allowed(const KeyRule& rule) {
  const ordered_json one = number(rule.whole ? "integer" : "number", rule.low, rule.high);
  switch (rule.kind) {
    case KeyRule::Kind::kNumber:
      return one;
    case KeyRule::Kind::kInteger:
      return number("integer", rule.low, rule.high);
    case KeyRule::Kind::kNumbers:
      return list_of(one, rule.count, rule.count);
    case KeyRule::Kind::kNumberOrList:
      return {{"anyOf", {one, list_of(one, 0, rule.count)}}};
    case KeyRule::Kind::kFile:
      return {{"type", "string"}};
    case KeyRule::Kind::kText:
      break;
  }
  return one_of_words(rule.choices);
}

/// The rule of a "section.key", by its last part.
void add(ordered_json& section, const KeyRule& rule) {
  ordered_json key = allowed(rule);
  const std::string unit = unit_of(rule.name);
  key["description"] = rule.what + (unit.empty() ? "" : " [" + unit + "]");
  section[rule.name.substr(rule.name.find('.') + 1)] = key;
}

ordered_json randomize_table() {
  ordered_json keys = ordered_json::object();
  add(keys, randomize_level_rule());
  for (const auto& key : randomize_keys()) add(keys, key.rule);
  ordered_json result = table(keys);
  result["description"] = "what a seed changes: one standard deviation each";
  return result;
}

ordered_json faults_table() {
  ordered_json keys = ordered_json::object();
  for (const auto& key : fault_keys()) add(keys, key.rule);
  ordered_json result = table(keys);
  result["description"] = "what breaks in flight, when and by how much";
  return result;
}

/// As its example shows: a text, a number, or a list of so many numbers.
ordered_json allowed(const TrackKey& key) {
  const nlohmann::json example = files::parse_toml_value(key.example);
  const ordered_json one = number("number", key.low, key.high);
  if (example.is_array()) return list_of(one, example.size(), example.size());
  if (std::string_view{key.name} == "color")
    return {{"anyOf", {one_of_words(key.choices), list_of(one, 3, 3)}}};
  if (!key.choices.empty()) return one_of_words(key.choices);
  if (example.is_string()) return {{"type", "string"}};
  return example.is_number_integer() ? number("integer", key.low, key.high) : one;
}

ordered_json track_table(std::string_view section, const char* what) {
  ordered_json keys = ordered_json::object(), required = ordered_json::array();
  for (const TrackKey& key : track_keys()) {
    if (key.section != section) continue;
    const std::string otherwise = key.otherwise;
    ordered_json rule = allowed(key);
    rule["description"] = key.what + (otherwise.empty() ? "" : "; without it " + otherwise);
    rule["examples"] = ordered_json::array({ordered_json(files::parse_toml_value(key.example))});
    keys[key.name] = rule;
    if (otherwise.empty()) required.push_back(key.name);
  }
  ordered_json result = table(keys);
  if (!required.empty()) result["required"] = required;
  if (*what != '\0') result["description"] = what;
  return result;
}

}  // namespace

ordered_json track_schema() {
  ordered_json top = track_table("", "");
  ordered_json gate = track_table("gates", "a gate");
  gate["properties"]["exit"] =
      track_table("exit", "how to leave this gate, for control.mode = \"paper\" only");
  ordered_json obstacle = track_table("obstacles", "a box or a pole");
  for (const char* shape : {"box_m", "pole_m"})
    obstacle["oneOf"].push_back({{"required", ordered_json::array({shape})}});
  ordered_json& keys = top["properties"];
  keys["start"] = track_table("start", "where the drone stands; without it at [0, 0], to north");
  keys["gates"] = list_of(gate, 1, kMaxGates);
  keys["gates"]["description"] = "in the order of flight";
  keys["obstacles"] = list_of(obstacle, 0, kMaxObstacles);
  keys["obstacles"]["description"] = "boxes and poles that stand on the floor";
  keys["room"] = track_table("room", "walls, ceiling, light");
  keys["randomize"] = randomize_table();
  keys["faults"] = faults_table();
  top["required"] = ordered_json::array({"gates"});
  return document("A track file of gatefly", top);
}

ordered_json config_schema() {
  ordered_json sections = ordered_json::object();
  for (const auto& key : config_keys()) {
    const std::string section = key.rule.name.substr(0, key.rule.name.find('.'));
    if (!sections.contains(section)) sections[section] = table(ordered_json::object());
    add(sections[section]["properties"], key.rule);
  }
  sections["randomize"] = randomize_table();
  sections["faults"] = faults_table();
  return document("A configuration of gatefly", table(sections));
}

}  // namespace gatefly::config
